//! Pattern, scatter and elimination against dense references.

mod common;

use algebra::{BlockLayout, BlockSystem, Constraints, Contributions, DofId, LocalSystem, Pattern, check_tangent};
use common::{Flow, Part, max_norm, refs, scalar_field, state};
use proptest::prelude::*;

/// Returns items with given dofs, a full tangent of distinct entries and a residual that is affine or quadratic.
fn items(dofs: &[Vec<usize>], is_linear: bool) -> Part<'_> {
    let add = move |item: usize, x: &[f64], out: &mut LocalSystem| {
        for i in 0..dofs[item].len() {
            out.add(i, 0.5 + i as f64);
            for (j, dof) in dofs[item].iter().enumerate() {
                let k = ((7 * item + 3 * i + j) as f64).sin();
                let (value, slope) = if is_linear { (x[*dof], 1.0) } else { (x[*dof].powi(2), 2.0 * x[*dof]) };
                out.add(i, k * value);
                out.add_tangent(i, j, k * slope);
            }
        }
    };
    let part = Part::new("items", dofs.len(), |item| dofs[item].clone(), add);
    if is_linear { part.linear() } else { part }
}

/// Assembles residual and tangent (column by column) in dense arrays.
fn dense(n: usize, list: &[&dyn Contributions], constraints: &Constraints, x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let (mut residual, mut tangent) = (vec![0.0; n], vec![0.0; n * n]);
    let mut local = LocalSystem::new();
    for contribution in list {
        for item in 0..contribution.len() {
            let mut dofs = Vec::new();
            contribution.dofs(item, &mut dofs);
            local.reset(dofs.len());
            contribution.add(item, x, &mut local);
            for (i, row) in dofs.iter().enumerate() {
                residual[row.index()] += local.residual()[i];
                for (j, column) in dofs.iter().enumerate() {
                    tangent[column.index() * n + row.index()] += local.tangent_at(i, j);
                }
            }
        }
    }
    for (dof, _) in constraints.iter() {
        let d = dof.index();
        residual[d] = 0.0;
        for k in 0..n {
            tangent[d * n + k] = 0.0;
            tangent[k * n + d] = 0.0;
        }
        tangent[d * n + d] = 1.0;
    }
    (residual, tangent)
}

fn assert_matches_dense(system: &BlockSystem, n: usize, reference: (Vec<f64>, Vec<f64>)) {
    let close = |a: f64, b: f64| (a - b).abs() <= 1e-12 * (1.0 + a.abs() + b.abs());
    for (r, e) in system.residual().iter().zip(&reference.0) {
        assert!(close(*r, *e), "{r} {e}");
    }
    let mut assembled = vec![0.0; n * n];
    for (value, (i, j)) in system.matrix().iter() {
        assembled[j as usize * n + i as usize] = *value;
    }
    for (a, e) in assembled.iter().zip(&reference.1) {
        assert!(close(*a, *e), "{a} {e}");
    }
}

fn distinct_dofs(n: usize, max_items: usize) -> impl Strategy<Value = Vec<Vec<usize>>> {
    prop::collection::vec(
        prop::sample::subsequence((0..n).collect::<Vec<_>>(), 0..=n.min(5)).prop_shuffle(),
        0..max_items,
    )
}

proptest! {
    #[test]
    fn pattern_and_assembly_match_the_dense_reference(
        linear in distinct_dofs(12, 12),
        nonlinear in distinct_dofs(12, 12),
        constrained in prop::collection::vec(0..12_usize, 0..4),
    ) {
        let n = 12;
        let parts = [items(&linear, true), items(&nonlinear, false)];
        let list = refs(&parts);
        let pattern = Pattern::new(n, &list);
        for column in 0..n {
            let mut rows: Vec<u32> = vec![column as u32];
            for dofs in linear.iter().chain(&nonlinear).filter(|dofs| dofs.contains(&column)) {
                rows.extend(dofs.iter().map(|d| *d as u32));
            }
            rows.sort_unstable();
            rows.dedup();
            let (begin, end) = (pattern.column_ptr()[column] as usize, pattern.column_ptr()[column + 1] as usize);
            prop_assert_eq!(&pattern.rows()[begin..end], &rows[..]);
        }
        let constraints: Constraints = constrained.iter().map(|d| (DofId::new(*d), 0.7)).collect();
        let mut x = state(n);
        constraints.apply(&mut x);
        let mut system = BlockSystem::new(&scalar_field(n), &list, &constraints);
        system.assemble(&list, &x);
        assert_matches_dense(&system, n, dense(n, &list, &constraints, &x));
        let residual = system.residual().to_vec();
        system.assemble_residual(&list, &x);
        prop_assert_eq!(system.residual(), &residual[..]);
        prop_assert!(list.iter().all(|part| check_tangent(*part, &x, 1e-5) < 1e-8));
    }
}

#[test]
fn bits_do_not_depend_on_the_number_of_threads() {
    let flow = Flow::new(24, 1.0);
    let x = state(flow.layout.len());
    let assemble = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let parts = [flow.parts(), vec![flow.jumps(0), flow.jumps(1)]].concat();
            let list = refs(&parts);
            let mut system = BlockSystem::new(&flow.layout, &list, &flow.constraints);
            system.assemble(&list, &x);
            let bits = |v: &[f64]| v.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            (bits(system.residual()), bits(system.matrix().data()))
        })
    };
    let one = assemble(1);
    for threads in [2, 3, 4] {
        assert!(one == assemble(threads), "{threads} threads");
    }
}

#[test]
fn a_single_field_is_divided_among_threads() {
    // Far couplings, so that many items touch several threads' shares.
    let n = 2000;
    let dofs = (0..n).map(|k| vec![k, (k + 1) % n, (7 * k + 900) % n]);
    let dofs: Vec<_> = dofs.filter(|d| d[2] != d[0] && d[2] != d[1]).collect();
    let items = items(&dofs, false);
    let mut x = state(n);
    let constraints: Constraints = [(DofId::new(3), 0.5), (DofId::new(1500), -0.25)].into_iter().collect();
    constraints.apply(&mut x);
    let reference = dense(n, &[&items], &constraints, &x);
    for threads in [1, 2, 3] {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let mut system = BlockSystem::new(&scalar_field(n), &[&items], &constraints);
            system.assemble(&[&items], &x);
            assert_matches_dense(&system, n, reference.clone());
        });
    }
}

/// Contributions whose coefficients change while their dofs stay.
#[test]
fn a_known_pattern_takes_other_coefficients_and_other_constraints() {
    let n = 12;
    let dofs: Vec<Vec<usize>> = (0..n).map(|k| vec![k, (k + 5) % n, (k + 1) % n]).collect();
    // The first list has other entries, as its items have other numbers.
    let mut turned = dofs.clone();
    turned.rotate_left(4);
    let x = state(n);
    let (mut system, mut pattern) = (BlockSystem::default(), Vec::new());
    for (dofs, constrained) in [(&dofs, 3), (&dofs, 8), (&turned, 8), (&dofs, 3)] {
        let parts = [true, false].map(|is_linear| items(dofs, is_linear));
        let list = refs(&parts);
        let constraints: Constraints = [(DofId::new(constrained), 0.5)].into_iter().collect();
        let mut x = x.clone();
        constraints.apply(&mut x);
        system = system.recycle(&scalar_field(n), &list, &constraints);
        system.assemble(&list, &x);
        assert_matches_dense(&system, n, dense(n, &list, &constraints, &x));
        pattern.push(system.pattern().rows().to_vec());
    }
    assert!(pattern.iter().all(|rows| *rows == pattern[0]));
}

#[test]
fn a_recycled_system_is_a_new_system() {
    let mut recycled = BlockSystem::default();
    for m in [6, 3, 9, 1] {
        let flow = Flow::new(m, 1.0);
        let parts = flow.parts();
        let list = refs(&parts);
        let x = state(flow.layout.len());
        recycled = recycled.recycle(&flow.layout, &list, &flow.constraints);
        let mut new = BlockSystem::new(&flow.layout, &list, &flow.constraints);
        for system in [&mut recycled, &mut new] {
            system.assemble(&list, &x);
        }
        assert_eq!(recycled.matrix(), new.matrix());
        assert_eq!(recycled.residual(), new.residual());
        assert!(max_norm(new.residual()) > 0.0);
    }
}

#[test]
fn the_tangent_check_finds_a_wrong_entry_and_a_wrong_residual() {
    let wrong = |claims_linear: bool| {
        let add = move |item: usize, x: &[f64], out: &mut LocalSystem| {
            let wrong = if item == 1 && !claims_linear { -x[0] } else { x[0] };
            out.add_vector(0, [3.0 * x[0], x[0] * x[1]]);
            out.add_block(0, 0, [[3.0, x[1]], [0.0, wrong]]);
        };
        let part = Part::new("wrong", 2, |_| vec![0, 1], add);
        if claims_linear { part.linear() } else { part }
    };
    let worst = algebra::worst_tangent_entry(&wrong(false), 0..2, &[1.0, 2.0], 1e-6);
    assert_eq!((worst.item, worst.row, worst.column), (1, 1, 1));
    assert!(worst.relative > 0.5);
    assert!(check_tangent(&wrong(true), &[1.0, 2.0], 1e-6) > 0.1);
    let nan = algebra::worst_tangent_entry(&wrong(false), 0..1, &[f64::NAN, 2.0], 1e-6);
    assert!(nan.relative.is_nan());
}

#[test]
fn nodes_and_keys_are_those_of_the_fields() {
    let mut layout = BlockLayout::new();
    let velocity = layout.push_keyed("velocity", vec![7, 5, 9], 2);
    let pressure = layout.push_on(velocity, "pressure", 1);
    let body = layout.push("body", 2, 2);
    assert_eq!(layout.nodes(), [0, 0, 1, 1, 2, 2, 0, 1, 2, 3, 3, 4, 4]);
    assert_eq!((layout.node_set(velocity), layout.node_set(pressure)), (0, 0));
    assert_eq!(layout.node(body, 1).map(DofId::index).collect::<Vec<_>>(), [11, 12]);
    // A key names field, component and node, whatever other nodes there are.
    let mut later = BlockLayout::new();
    let moved = later.push_keyed("velocity", vec![9, 4], 2);
    later.push_on(moved, "pressure", 1);
    later.push("body", 2, 2);
    let (keys, later_keys) = (layout.keys(), later.keys());
    let found = |dof: usize| keys.iter().position(|key| *key == later_keys[dof]);
    let expected = [Some(4), Some(5), None, None, Some(8), None, Some(9), Some(10), Some(11), Some(12)];
    assert_eq!(std::array::from_fn(found), expected);
}

#[test]
#[should_panic(expected = "items item 0: dof 5 of 3")]
fn a_dof_outside_of_the_layout_is_named() {
    let _ = Pattern::new(3, &[&items(&[vec![0, 5]], true)]);
}
