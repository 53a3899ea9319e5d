//! What paths would find if every patch of the windows, or of the sky, had a radiance of one.

use super::Rgb;
use crate::basis::Basis;
use crate::direction::Disk;
use crate::geometry::Vec3;
use crate::sky::patches::SkyPatches;

/// What light is told apart by.
#[derive(Debug, Clone, Copy)]
pub(super) enum Targets<'a> {
    /// Directions into the room, by the group of the window: groups of all windows, and the patches of each group.
    Windows(&'a [usize], &'a Basis),
    /// Patches of the sky.
    Sky(&'a SkyPatches),
}

impl Targets<'_> {
    /// Number of columns.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Windows(groups, basis) => groups.iter().max().map_or(0, |most| (most + 1) * basis.len()),
            Self::Sky(patches) => patches.len(),
        }
    }
}

/// Sums over the paths of a row of a matrix.
pub(super) struct Ledger<'a> {
    targets: Targets<'a>,
    /// Light that met fewer surfaces on its way than the first does not count; up to the second it is direct.
    meetings: [u16; 2],
    /// Of all light, by column.
    pub(super) all: Vec<Rgb>,
    /// Of direct light.
    pub(super) direct: Vec<Rgb>,
}

impl<'a> Ledger<'a> {
    pub(super) fn new(targets: Targets<'a>, meetings: [u16; 2]) -> Self {
        let none = vec![[0.0; 3]; targets.len()];
        Self {
            targets,
            meetings,
            all: none.clone(),
            direct: none,
        }
    }

    /// Whether windows are asked for light.
    pub(super) fn asks_windows(&self) -> bool {
        matches!(self.targets, Targets::Windows(..))
    }

    /// A path finds a window, whose light travels so in its frame.
    pub(super) fn window(&mut self, number: usize, travel: Disk, share: Rgb, meetings: u16) {
        if let Targets::Windows(groups, basis) = self.targets {
            let column = groups[number] * basis.len() + basis.patch_of(travel);
            self.add(column, share, meetings);
        }
    }

    /// A path leaves towards the sky or the ground.
    pub(super) fn sky(&mut self, direction: Vec3, share: Rgb, meetings: u16) {
        if let Targets::Sky(patches) = self.targets {
            self.add(patches.patch_of(direction), share, meetings);
        }
    }

    fn add(&mut self, column: usize, share: Rgb, meetings: u16) {
        let [least, direct] = self.meetings;
        if meetings < least {
            return;
        }
        let add = |to: &mut Rgb| to.iter_mut().zip(share).for_each(|(sum, s)| *sum += s);
        add(&mut self.all[column]);
        if meetings <= direct {
            add(&mut self.direct[column]);
        }
    }
}
