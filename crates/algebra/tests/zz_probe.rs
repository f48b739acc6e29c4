mod common;
use std::time::Instant;
use algebra::*;
use common::*;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::sparse::linalg::lu::*;
use faer::sparse::linalg::SupernodalThreshold;
use faer::{Par};
use faer::dyn_stack::*;

fn ms(b: Instant) -> f64 { b.elapsed().as_secs_f64()*1e3 }
fn faults() -> (u64, f64, f64) {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[7].parse().unwrap(), f[11].parse::<f64>().unwrap()*10.0, f[12].parse::<f64>().unwrap()*10.0)
}
#[test]
#[ignore]
fn probe() {
    let mut numeric = NumericLu::<u32, f64>::new();
    for m in [90, 89, 91, 90] {
        let flow = Flow::new(m, 1.0);
        let (linear, convection, jumps) = flow.parts();
        let list: Vec<&dyn Contributions> = vec![&linear, &convection, &jumps[0], &jumps[1], &jumps[2]];
        let mut system = BlockSystem::new(&flow.layout, &list, &flow.constraints);
        system.assemble(&list, &state(flow.layout.len()));
        let mtx = system.matrix();
        let eq = Equilibration::new(mtx).unwrap();
        let b = Instant::now(); let _ = Equilibration::new(mtx).unwrap(); println!("m {m} equil {:.1}", ms(b));
        let mut vals = Vec::new();
        for (j, c) in mtx.outer_iterator().enumerate() { for (i, v) in c.iter() { vals.push(v*eq.row()[i]*eq.column()[j]); } }
        let ip = mtx.indptr();
        let n = mtx.rows();
        let sy = SymbolicSparseColMatRef::new_checked(n, n, ip.raw_storage(), None, mtx.indices());
        let a = SparseColMatRef::new(sy, &vals);
        for (name, thr) in [("auto", SupernodalThreshold::AUTO), ("super", SupernodalThreshold::FORCE_SUPERNODAL), ("simpl", SupernodalThreshold::FORCE_SIMPLICIAL)] {
            if name != "auto" && m != 90 { continue; }
            let b = Instant::now();
            let f0 = faults();
            let mut p = LuSymbolicParams::default();
            p.supernodal_flop_ratio_threshold = thr;
            let sym = factorize_symbolic_lu(sy, p).unwrap();
            let f1 = faults();
            println!("{name}: symbolic {:.1}  faults {} user {} sys {}", ms(b), f1.0-f0.0, f1.1-f0.1, f1.2-f0.2);
            let mut own = NumericLu::new();
            for which in 0..2 {
                let num = if which == 0 {&mut own} else {&mut numeric};
                for k in 0..3 {
                    let mut mem = MemBuffer::new(sym.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default()));
                    let b = Instant::now();
                    let f0 = faults();
                    sym.factorize_numeric_lu(num, a, Par::Seq, MemStack::new(&mut mem), Default::default()).unwrap();
                    let f1 = faults();
                    println!("   {} numeric {k} {:.1} faults {} user {} sys {}", if which==0{"own "} else {"kept"}, ms(b), f1.0-f0.0, f1.1-f0.1, f1.2-f0.2);
                }
            }
        }
    }
}
