//! Sets of small numbers, one bit each.
//!
//! Sets of slots ([`Slots`]) and of vertices are `u32`. Sets of behaviours, of resources, and of the
//! edges or productions of one plan frame are `u16`. The limits of the blob keep all members below
//! the width of their set.

use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};

/// A set of slots of the pool.
pub type Slots = u32;

const _: () = assert!(MAX_COMPONENTS <= Slots::BITS as usize, "a set has all slots");
const _: () = assert!(MAX_BEHAVIOURS <= u16::BITS as usize, "sets of behaviours are u16");

/// The set of one number; empty if the number is 32 or more.
///
/// ```
/// assert_eq!(parts::bits::bit(3), 0b1000);
/// assert_eq!(parts::bits::bit(32), 0);
/// ```
pub const fn bit(number: u8) -> u32 {
    match 1_u32.checked_shl(number as u32) {
        Some(bit) => bit,
        None => 0,
    }
}

/// As [`bit`], for a set of 16 bits; empty if the number is 16 or more.
///
/// ```
/// assert_eq!(parts::bits::bit16(3), 0b1000);
/// assert_eq!(parts::bits::bit16(16), 0);
/// ```
pub const fn bit16(number: u8) -> u16 {
    bit(number) as u16
}

/// The members of a set, in ascending order.
///
/// ```
/// assert!(parts::bits::members(0b1011).eq([0, 1, 3]));
/// ```
pub fn members(mut set: u32) -> impl Iterator<Item = u8> {
    core::iter::from_fn(move || {
        let number = set.trailing_zeros();
        set &= set.wrapping_sub(1);
        (number < u32::BITS).then_some(number as u8)
    })
}
