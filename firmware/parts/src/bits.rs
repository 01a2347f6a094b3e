//! Sets of small numbers, one bit each.
//!
//! Sets of slots are [`Slots`]. Sets of vertices are `u32`. Sets of behaviours, of resources, and of
//! the edges or productions of one plan frame are `u16`. The limits of the blob keep all members
//! below the width of their set.

use core::ops::BitAnd;

use plan_format::limits::{MAX_BEHAVIOURS, MAX_COMPONENTS};

use crate::Id;

/// Slots in one word of a set.
const WORD: u8 = u32::BITS as u8;

/// A set of slots of the pool: two words, because the microcontrollers have no wider ones. Nearly
/// all missions need the first word only.
///
/// ```
/// use parts::bits::Slots;
/// let mut slots = Slots::NONE;
/// for id in [40, 0, 31, 32, 40] {
///     slots.insert(id);
/// }
/// assert!(slots.iter().eq([0, 31, 32, 40]) && slots.contains(32) && !slots.contains(8));
/// slots.remove(32);
/// slots.remove(31);
/// assert_eq!((slots.len(), slots.first_missing()), (2, 1));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slots {
    low: u32,
    high: u32,
}

impl Slots {
    /// The set without members.
    pub const NONE: Self = Self { low: 0, high: 0 };

    /// Whether a slot is a member.
    pub const fn contains(self, id: Id) -> bool {
        let (word, number) = if id < WORD { (self.low, id) } else { (self.high, id - WORD) };
        word & bit(number) != 0
    }

    /// Adds a slot below 64.
    pub const fn insert(&mut self, id: Id) {
        if id < WORD {
            self.low |= bit(id);
        } else {
            self.high |= bit(id - WORD);
        }
    }

    /// Takes a slot out.
    pub const fn remove(&mut self, id: Id) {
        if id < WORD {
            self.low &= !bit(id);
        } else {
            self.high &= !bit(id - WORD);
        }
    }

    /// Whether it has no members.
    pub const fn is_empty(self) -> bool {
        self.low | self.high == 0
    }

    /// Number of members.
    pub const fn len(self) -> usize {
        (self.low.count_ones() + self.high.count_ones()) as usize
    }

    /// The lowest number that is not a member.
    pub const fn first_missing(self) -> Id {
        let low = self.low.trailing_ones();
        (if low < u32::BITS { low } else { low + self.high.trailing_ones() }) as Id
    }

    /// The members, in ascending order.
    pub fn iter(self) -> impl Iterator<Item = Id> {
        let Self { low: mut word, mut high } = self;
        let mut first = 0;
        core::iter::from_fn(move || {
            if word == 0 {
                (word, high, first) = (high, 0, WORD);
            }
            let number = word.trailing_zeros() as u8;
            word &= word.wrapping_sub(1);
            (number < WORD).then(|| first + number)
        })
    }
}

impl BitAnd for Slots {
    type Output = Self;

    fn bitand(self, other: Self) -> Self {
        Self { low: self.low & other.low, high: self.high & other.high }
    }
}

const _: () = assert!(MAX_COMPONENTS <= 2 * WORD as usize, "a set has all slots");
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

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use std::vec::Vec;

    const END: Id = 2 * WORD;

    fn of(ids: impl IntoIterator<Item = Id>) -> Slots {
        let mut slots = Slots::NONE;
        ids.into_iter().for_each(|id| slots.insert(id));
        slots
    }

    #[test]
    fn sets_of_two_slots() {
        for (one, other) in (0..END).flat_map(|one| (0..END).map(move |other| (one, other))) {
            let mut slots = of([one, other]);
            let mut sorted = Vec::from([one, other]);
            sorted.sort_unstable();
            sorted.dedup();
            assert!(slots.iter().eq(sorted.iter().copied()), "{one} {other}");
            assert!((0..END).all(|id| slots.contains(id) == sorted.contains(&id)), "{one} {other}");
            assert!(slots.len() == sorted.len() && !slots.is_empty(), "{one} {other}");
            let common = if one == other { of([one]) } else { Slots::NONE };
            assert_eq!(of([one]) & of([other]), common);
            slots.remove(one);
            assert_eq!(slots, if one == other { Slots::NONE } else { of([other]) });
            slots.remove(other);
            assert!(slots.is_empty() && slots == Slots::NONE, "{one} {other}");
        }
    }

    #[test]
    fn the_first_slot_that_is_missing() {
        for first in 0..END {
            assert_eq!(of(0..first).first_missing(), first);
            assert_eq!(of((0..END).filter(|&id| id != first)).first_missing(), first);
        }
        assert_eq!(of(0..END).first_missing(), END);
        assert_eq!(of(1..END) & of(0..40), of(1..40));
    }
}
