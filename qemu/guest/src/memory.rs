//! How much memory the image takes.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
    static __sdata: u32;
    static __edata: u32;
    static __sbss: u32;
    static __ebss: u32;
}

/// Bytes of stack used since reset, at their most, by the paint that start-up laid on it.
pub fn stack_bytes() -> usize {
    let top = (&raw const _stack_start).addr();
    let mut word = &raw const _stack_end;
    // SAFETY: `word` stays inside the stack's region, which is plain memory that start-up has
    // painted; volatile, because the compiler does not know of that.
    while word.addr() < top && unsafe { word.read_volatile() } == STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    top - word.addr()
}

/// Bytes of all static memory: tasks and everything that they keep between ticks.
pub fn static_bytes() -> usize {
    let data = (&raw const __edata).addr() - (&raw const __sdata).addr();
    let bss = (&raw const __ebss).addr() - (&raw const __sbss).addr();
    data + bss
}
