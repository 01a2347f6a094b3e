//! The passes over all columns of a row in AVX-512, with two tricks that the compiler does not find
//! in the passes of [`super`].
//!
//! A mask of columns is four mask registers as it is: no column need be tested. And a row can be
//! shifted by one column in registers, from two halves. Loading it one column aside is slow: the load
//! spans two stores that have just written the row, and waits until the cache has both.

use super::{DIAGONAL, GAP, Row, SIDE, STRAIGHT, UNKNOWN};
use pulp::bytemuck::{cast_mut, cast_ref};
use pulp::x86::V4;
use pulp::{Simd, b16, cast, u32x16};
use std::any::Any;
use std::arch::x86_64::__m512i;

/// Columns in a register.
const LANES: usize = 16;
/// Number of registers for a row.
type Columns = [u32x16; SIDE / LANES];

/// The vector unit, if it is AVX-512; decided at compile time.
#[inline(always)]
pub(super) fn of<S: Simd>(simd: S) -> Option<V4> {
    (&simd as &dyn Any).downcast_ref().copied()
}

/// As [`super::step_over`].
#[inline(always)]
pub(super) fn step_over(
    simd: V4,
    target: &mut [u32; SIDE],
    source: &Row,
    passes: [u64; 3],
) -> bool {
    let [from_west, straight, from_east] = shifted(simd, source);
    let unknown = simd.splat_u32x16(UNKNOWN);
    let target: &mut Columns = cast_mut(target);
    let mut changed = 0;
    for (part, cost) in target.iter_mut().enumerate() {
        let [open, west, east] = passes.map(|mask| b16((mask >> (LANES * part)) as u16));
        let west = simd.select_u32x16(west, from_west[part], unknown);
        let east = simd.select_u32x16(east, from_east[part], unknown);
        let straight = plus(simd, straight[part], STRAIGHT);
        let diagonal = plus(simd, simd.min_u32x16(west, east), DIAGONAL);
        let found = simd.min_u32x16(simd.select_u32x16(open, straight, unknown), diagonal);
        changed |= simd.cmp_lt_u32x16(found, *cost).0;
        *cost = simd.min_u32x16(found, *cost);
    }
    changed != 0
}

/// As [`super::slopes`].
#[inline(always)]
pub(super) fn slopes(simd: V4, row: &Row) -> [u64; 2] {
    let [west, here, east] = shifted(simd, row);
    let mut slopes = [0; 2];
    for part in 0..here.len() {
        let next = plus(simd, here[part], STRAIGHT);
        for (slope, beside) in slopes.iter_mut().zip([east[part], west[part]]) {
            *slope |= u64::from(simd.cmp_lt_u32x16(next, beside).0) << (LANES * part);
        }
    }
    slopes
}

/// For each column, the costs of the column west of it, of itself and of the column east of it.
#[inline(always)]
fn shifted(simd: V4, row: &Row) -> [Columns; 3] {
    let parts: &[u32x16; (GAP + SIDE + GAP) / LANES] = cast_ref(row);
    let mut columns = [[parts[0]; SIDE / LANES]; 3];
    let [west, here, east] = &mut columns;
    for part in 0..SIDE / LANES {
        let [before, this, after]: [__m512i; 3] = [0, 1, 2].map(|next| cast(parts[part + next]));
        west[part] = cast(simd.avx512f._mm512_alignr_epi32::<{ LANES as i32 - 1 }>(this, before));
        here[part] = cast(this);
        east[part] = cast(simd.avx512f._mm512_alignr_epi32::<1>(after, this));
    }
    columns
}

/// Adds a step of the given cost to every column.
#[inline(always)]
fn plus(simd: V4, cost: u32x16, step: u32) -> u32x16 {
    simd.wrapping_add_u32x16(cost, simd.splat_u32x16(step))
}
