//! The kinds of vector unit that a search may be run with.
//!
//! A search takes the best that the machine has. The others are here so that tests can show that
//! all of them find the same field, and benchmarks what a lesser machine would take.

/// A kind of vector unit that this machine has.
#[derive(Clone, Copy, Debug)]
pub struct Vectors {
    arch: pulp::Arch,
    name: &'static str,
}

impl Vectors {
    /// The best there is.
    pub fn best() -> Self {
        Self::named(pulp::Arch::new())
    }

    /// All there are, the best first. The last is what every machine of this kind has.
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

    /// What its makers call it.
    pub fn name(self) -> &'static str {
        self.name
    }

    /// Runs what was compiled for it.
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
