//! Where the traced flux went.

/// One band's flux by what became of it: traced, transmitted, reflected, absorbed, roulette, cut off, lost. The first is the
/// sum of the others.
pub type Tallies = [f64; 7];

/// Flux by what became of it, one value a band, in units of one path's flux. `traced` is the sum of all others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance<const N: usize> {
    /// What was sent in.
    pub traced: [f64; N],
    /// Left on the other side.
    pub transmitted: [f64; N],
    /// Left on the side that it came from.
    pub reflected: [f64; N],
    /// Stayed in surfaces and media, tallied at each event.
    pub absorbed: [f64; N],
    /// Taken off less added by random choices (roulette and lobes); its mean is zero.
    pub roulette: [f64; N],
    /// Still on its way after the greatest number of events.
    pub cut_off: [f64; N],
    /// Could not be followed.
    pub lost: [f64; N],
}

impl<const N: usize> Default for Balance<N> {
    fn default() -> Self {
        let zero = [0.0; N];
        Self {
            traced: zero,
            transmitted: zero,
            reflected: zero,
            absorbed: zero,
            roulette: zero,
            cut_off: zero,
            lost: zero,
        }
    }
}

/// Adds a path's flux to a tally.
#[inline]
pub(super) fn add<const N: usize>(tally: &mut [f64; N], flux: &[f64; N]) {
    for (t, f) in tally.iter_mut().zip(flux) {
        *t += f;
    }
}

impl<const N: usize> Balance<N> {
    /// The tallies of a band: traced, transmitted, reflected, absorbed, roulette, cut off, lost.
    pub fn of_band(&self, band: usize) -> Tallies {
        [
            &self.traced,
            &self.transmitted,
            &self.reflected,
            &self.absorbed,
            &self.roulette,
            &self.cut_off,
            &self.lost,
        ]
        .map(|tally| tally[band])
    }

    /// Takes over another one's flux.
    pub fn merge(&mut self, other: &Self) {
        add(&mut self.traced, &other.traced);
        add(&mut self.transmitted, &other.transmitted);
        add(&mut self.reflected, &other.reflected);
        add(&mut self.absorbed, &other.absorbed);
        add(&mut self.roulette, &other.roulette);
        add(&mut self.cut_off, &other.cut_off);
        add(&mut self.lost, &other.lost);
    }
}
