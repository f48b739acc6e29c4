//! Cursor over the bytes of a file that reads words, or numbers in binary.

/// Representation of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    /// Words between white space.
    Text,
    /// Four or eight bytes each, the lowest one first unless `swapped`.
    Binary {
        /// Whether the highest byte comes first.
        swapped: bool,
    },
}

/// Cursor over the bytes of a file. Its errors begin with the line (text) or the byte (binary).
pub(super) struct Scan<'b> {
    bytes: &'b [u8],
    at: usize,
    pub(super) encoding: Encoding,
}

impl<'b> Scan<'b> {
    pub(super) fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 0, encoding: Encoding::Text }
    }

    /// Returns a message that begins with the line or byte of the cursor.
    pub(super) fn fail(&self, message: impl std::fmt::Display) -> String {
        match self.encoding {
            Encoding::Text => {
                // White space behind the last word may have been passed already.
                let read = self.bytes[..self.at].trim_ascii_end();
                format!("line {}: {message}", read.iter().filter(|byte| **byte == b'\n').count() + 1)
            }
            Encoding::Binary { .. } => format!("byte {}: {message}", self.at),
        }
    }

    /// Returns the next line that is not empty, without white space at its ends, in either encoding.
    pub(super) fn line(&mut self) -> Option<&'b [u8]> {
        while self.at < self.bytes.len() {
            let rest = &self.bytes[self.at..];
            let end = rest.iter().position(|byte| *byte == b'\n').map_or(rest.len(), |end| end + 1);
            self.at += end;
            let line = rest[..end].trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
        None
    }

    /// Returns the next line as text.
    pub(super) fn text_line(&mut self) -> Result<&'b str, String> {
        let line = self.line().ok_or_else(|| self.ended())?;
        std::str::from_utf8(line).map_err(|_| self.fail("this line is not UTF-8; save the file in that encoding"))
    }

    /// Skips the rest of a section and its last line.
    pub(super) fn skip_section(&mut self, name: &str) -> Result<(), String> {
        let end = format!("$End{name}");
        let found = self.bytes[self.at..].windows(end.len()).position(|window| window == end.as_bytes());
        self.at += found.ok_or_else(|| self.fail(format!("the section `${name}` has no end; the file is cut off")))?;
        self.line();
        Ok(())
    }

    /// Reads the end of a section.
    pub(super) fn end_section(&mut self, name: &str) -> Result<(), String> {
        let found = self.line().map(|line| String::from_utf8_lossy(line).into_owned());
        match found {
            Some(line) if line == format!("$End{name}") => Ok(()),
            Some(line) => {
                let line: String = line.chars().take(40).collect();
                Err(self.fail(format!(
                    "`{line}` is found instead of `$End{name}`; the section has more entries than it states"
                )))
            }
            None => Err(self.ended()),
        }
    }

    fn ended(&self) -> String {
        self.fail("the file ends here, within a section; it is cut off")
    }

    /// Checks a number of entries against the bytes that are left, at least one per entry, and returns it.
    pub(super) fn count(&self, n: u64) -> Result<usize, String> {
        let left = self.bytes.len() - self.at;
        usize::try_from(n).ok().filter(|n| *n <= left).ok_or_else(|| {
            self.fail(format!(
                "{n} entries are announced, but only {left} bytes follow; the file is cut off or damaged"
            ))
        })
    }

    fn word(&mut self) -> Result<&'b str, String> {
        let rest = &self.bytes[self.at..];
        let begin = rest.iter().position(|byte| !byte.is_ascii_whitespace()).ok_or_else(|| self.ended())?;
        let length = rest[begin..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - begin);
        self.at += begin + length;
        let word = &rest[begin..begin + length];
        std::str::from_utf8(word).map_err(|_| self.fail("this is not a number but binary data"))
    }

    fn parsed<T: std::str::FromStr>(&mut self, expected: &str) -> Result<T, String> {
        let word = self.word()?;
        let short = || word.chars().take(40).collect::<String>();
        if word.starts_with("$End") {
            return Err(self.fail(format!(
                "`{}` is found within the entries of the section; the file is damaged, save the mesh again",
                short()
            )));
        }
        word.parse().map_err(|_| self.fail(format!("`{}` is not {expected}", short())))
    }

    /// Reads `n` bytes of a number, at most eight. Returns the lowest byte first, followed by zeros.
    fn binary(&mut self, n: usize) -> Result<[u8; 8], String> {
        let found = self.bytes[self.at..].get(..n).ok_or_else(|| self.ended())?;
        let mut bytes = [0; 8];
        bytes[..n].copy_from_slice(found);
        if self.encoding == (Encoding::Binary { swapped: true }) {
            bytes[..n].reverse();
        }
        self.at += n;
        Ok(bytes)
    }

    /// Reads a whole number of four bytes.
    pub(super) fn int(&mut self) -> Result<i32, String> {
        match self.encoding {
            Encoding::Text => self.parsed("a whole number"),
            Encoding::Binary { .. } => self.binary(4).map(|bytes| u64::from_le_bytes(bytes) as i32),
        }
    }

    /// Reads a whole number of eight bytes that is not negative.
    pub(super) fn size(&mut self) -> Result<u64, String> {
        match self.encoding {
            Encoding::Text => self.parsed("a whole number, zero or above"),
            Encoding::Binary { .. } => self.binary(8).map(u64::from_le_bytes),
        }
    }

    /// Reads a finite number.
    pub(super) fn real(&mut self) -> Result<f64, String> {
        let number = match self.encoding {
            Encoding::Text => self.parsed("a number")?,
            Encoding::Binary { .. } => f64::from_le_bytes(self.binary(8)?),
        };
        if number.is_finite() { Ok(number) } else { Err(self.fail(format!("the coordinate {number} is not finite"))) }
    }

    /// Reads the integer 1 of a binary file, and sets the order of bytes from it.
    pub(super) fn byte_order(&mut self) -> Result<(), String> {
        self.encoding = Encoding::Binary { swapped: false };
        let one = self.int()?;
        self.encoding = Encoding::Binary { swapped: one == 1 << 24 };
        if one == 1 || one == 1 << 24 { Ok(()) } else { Err(self.fail("the integer 1 of a binary file is missing")) }
    }
}
