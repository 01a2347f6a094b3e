//! How much stack was ever used, by the paint that start-up laid on it.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
}

/// Bytes of stack used since reset, at their most.
pub fn high_water_bytes() -> usize {
    let top = &raw const _stack_start as usize;
    let mut word = &raw const _stack_end;
    // SAFETY: `word` stays inside the stack's region, which is plain memory that start-up has
    // painted; volatile, because the compiler does not know of that.
    while (word as usize) < top && unsafe { word.read_volatile() } == STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    top - word as usize
}
