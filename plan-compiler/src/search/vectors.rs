//! The kinds of vector unit that a search may be run with.
//!
//! A search uses the best unit of the machine. The others exist so that tests can prove that all find
//! the same field, and benchmarks can measure what a lesser machine would take.

/// A kind of vector unit that this machine has.
#[derive(Clone, Copy, Debug)]
pub struct Vectors {
    arch: pulp::Arch,
    name: &'static str,
}

impl Vectors {
    /// The best unit of this machine.
    pub fn best() -> Self {
        Self::named(pulp::Arch::new())
    }

    /// All units of this machine, the best first. The last exists on every machine of this
    /// architecture.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::best()];
        #[cfg(target_arch = "x86_64")]
        if let (pulp::Arch::V4(_), Some(simd)) = (all[0].arch, pulp::x86::V3::try_new()) {
            all.push(Self::named(pulp::Arch::V3(simd)));
        }
        if !matches!(all[0].arch, pulp::Arch::Scalar) {
            all.push(Self::named(pulp::Arch::Scalar));
        }
        all
    }

    fn named(arch: pulp::Arch) -> Self {
        let name = match arch {
            #[cfg(target_arch = "x86_64")]
            pulp::Arch::V4(_) => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            pulp::Arch::V3(_) => "AVX2",
            #[cfg(target_arch = "x86_64")]
            pulp::Arch::Scalar => "SSE2",
            _ => "vectors of this machine",
        };
        Self { arch, name }
    }

    /// Its usual name.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Runs an operation with this unit.
    #[inline(always)]
    pub(crate) fn run<Op: pulp::WithSimd>(self, op: Op) -> Op::Output {
        self.arch.dispatch(op)
    }
}

impl Default for Vectors {
    fn default() -> Self {
        Self::best()
    }
}
