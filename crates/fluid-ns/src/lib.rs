//! fluid-ns.
