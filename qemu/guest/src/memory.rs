//! Measures the memory of the image.

use cortex_m_rt::STACK_PAINT_VALUE;

unsafe extern "C" {
    static _stack_start: u32;
    static _stack_end: u32;
    static __sdata: u32;
    static __edata: u32;
    static __sbss: u32;
    static __ebss: u32;
}

/// Most bytes of stack used since reset, measured by the paint that start-up put there.
pub fn stack_bytes() -> usize {
    let top = (&raw const _stack_start).addr();
    let mut word = &raw const _stack_end;
    // SAFETY: `word` stays inside the stack's region, plain memory that start-up painted. The read
    // is volatile because the compiler does not know about the paint.
    while word.addr() < top && unsafe { word.read_volatile() } == STACK_PAINT_VALUE {
        word = word.wrapping_add(1);
    }
    top - word.addr()
}

/// Most bytes of stack that a call uses, its own frame included: paints the stack below, calls, and
/// searches the paint for changes.
#[inline(never)]
pub fn stack_bytes_of(call: impl FnOnce()) -> usize {
    /// Bytes below the stack pointer that this function itself may need.
    const OWN_BYTES: usize = 128;
    let top = cortex_m::register::msp::read() as usize - OWN_BYTES;
    let bottom = (&raw const _stack_end).addr();
    for address in (bottom..top).step_by(4) {
        // SAFETY: the words are in the stack's region, below the part in use.
        unsafe { (address as *mut u32).write_volatile(STACK_PAINT_VALUE) };
    }
    call();
    // SAFETY: as above; the call has returned, so nothing uses these words.
    let is_painted =
        |address| unsafe { (address as *const u32).read_volatile() } == STACK_PAINT_VALUE;
    let deepest = (bottom..top).step_by(4).find(|&address| !is_painted(address)).unwrap_or(top);
    top - deepest
}

/// Bytes of all static memory: the tasks and everything that they keep between ticks.
pub fn static_bytes() -> usize {
    let data = (&raw const __edata).addr() - (&raw const __sdata).addr();
    let bss = (&raw const __ebss).addr() - (&raw const __sbss).addr();
    data + bss
}
