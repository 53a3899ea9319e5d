//! Angle bases of a file: those that it lists, those that it only names, and what the count of values says.

use std::sync::Arc;

use super::metadata::Decoder;
use super::place;
use super::scan::{Node, shortened};
use crate::basis::{Basis, Ring};
use crate::error::{Error, Result};
use crate::io::counted;

/// Bases that WINDOW and Radiance know by name.
fn standard() -> [Basis; 3] {
    [Basis::klems_full(), Basis::klems_half(), Basis::klems_quarter()]
}

/// A basis that a block names.
#[derive(Debug, Clone)]
pub(super) enum Choice {
    /// Listed in the file.
    Listed {
        basis: Arc<Basis>,
        /// The standard basis of that name, if the listing differs from it.
        instead_of: Option<Arc<Basis>>,
    },
    /// Only named, but known.
    Named(Arc<Basis>),
    /// Neither.
    Unknown(String),
}

impl Choice {
    fn basis(&self) -> Option<&Arc<Basis>> {
        match self {
            Self::Listed { basis, .. } | Self::Named(basis) => Some(basis),
            Self::Unknown(_) => None,
        }
    }

    /// Whether another standard basis may stand in for it when the count of values says so.
    fn may_be_another(&self) -> bool {
        match self {
            Self::Listed { instead_of, .. } => instead_of.is_some(),
            Self::Named(_) | Self::Unknown(_) => true,
        }
    }

    /// What the file says of it, as a sentence.
    fn words(&self) -> String {
        let patches = |basis: &Basis| match basis.len() {
            1 => "1 patch".to_owned(),
            count => format!("{count} patches"),
        };
        match self {
            Self::Listed { basis, .. } => format!("angle basis {:?} is listed with {}", basis.name(), patches(basis)),
            Self::Named(basis) => format!("angle basis {:?} ({}) is not listed", basis.name(), patches(basis)),
            Self::Unknown(name) if name.is_empty() => "the angle basis has no name".to_owned(),
            Self::Unknown(name) => format!("angle basis {} is neither listed nor known", shortened(name)),
        }
    }

    /// Name, if the file leaves it at that.
    fn unlisted(&self) -> Option<&str> {
        match self {
            Self::Named(basis) => Some(basis.name()),
            Self::Listed { .. } | Self::Unknown(_) => None,
        }
    }
}

/// All bases of a file.
pub(super) struct Bases {
    listed: Vec<(String, Choice)>,
    /// Names in `<DataDefinition>`, with or without a listing.
    names: Vec<String>,
}

impl Bases {
    /// From the `<AngleBasis>` elements of `<DataDefinition>`.
    pub fn read(definition: Option<&Node<'_>>, decoder: &mut Decoder<'_, '_>) -> Result<Self> {
        let mut bases = Self {
            listed: Vec::new(),
            names: Vec::new(),
        };
        for node in definition.iter().flat_map(|d| d.all("AngleBasis")) {
            let name = node
                .child("AngleBasisName")
                .map_or_else(String::new, |n| decoder.line(n));
            if node.child("AngleBasisBlock").is_some() {
                let basis = Arc::new(listing(node, &name, decoder)?);
                let same_name = Basis::named(&name).ok();
                let instead_of = same_name.filter(|s| *s != *basis).map(Arc::new);
                if instead_of.is_some() {
                    let what =
                        format!("the listing of {name:?} is not the standard basis of that name; the listing is used");
                    decoder.faults.warn(node.at, node.name, what);
                }
                if bases.listed.iter().any(|(n, _)| *n == name.to_ascii_lowercase()) {
                    return Err(Error::format(
                        place(decoder.faults.bytes, node.at, node.name),
                        format!("angle basis {} is listed twice", shortened(&name)),
                        "give each listing a name of its own",
                    ));
                }
                let choice = Choice::Listed { basis, instead_of };
                bases.listed.push((name.to_ascii_lowercase(), choice));
            }
            bases.names.push(name);
        }
        Ok(bases)
    }

    /// The basis that a block's element names; without one the only basis of the file.
    pub fn choose(&self, node: Option<&Node<'_>>, decoder: &mut Decoder<'_, '_>) -> Choice {
        let mut name = node.map_or_else(String::new, |n| decoder.line(n));
        if name.is_empty()
            && let [only] = self.names.as_slice()
        {
            name.clone_from(only);
        }
        let key = name.to_ascii_lowercase();
        if let Some((_, choice)) = self.listed.iter().find(|(n, _)| *n == key) {
            return choice.clone();
        }
        match Basis::named(&name) {
            Ok(basis) => Choice::Named(Arc::new(basis)),
            Err(_) => Choice::Unknown(name),
        }
    }
}

/// A listing's rings.
fn listing(node: &Node<'_>, name: &str, decoder: &mut Decoder<'_, '_>) -> Result<Basis> {
    let mut rings = Vec::new();
    for block in node.all("AngleBasisBlock") {
        let bytes = decoder.faults.bytes;
        let fail = |what: String, remedy: &str| Err(Error::format(place(bytes, block.at, block.name), what, remedy));
        let mut number = |parent: Option<&Node<'_>>, field: &str| -> Result<Option<f64>> {
            let Some(field) = parent.and_then(|p| p.child(field)) else {
                return Ok(None);
            };
            let text = decoder.text(field);
            match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Ok(Some(value)),
                _ => Err(Error::format(
                    place(bytes, field.at, field.name),
                    format!("{} is not a number", shortened(&text)),
                    "numbers are written like 12.5",
                )),
            }
        };
        let bounds = block.child("ThetaBounds");
        let (lower, upper) = (number(bounds, "LowerTheta")?, number(bounds, "UpperTheta")?);
        let (Some(lower_deg), Some(upper_deg)) = (lower, upper) else {
            return fail(
                format!("ring {} has no <ThetaBounds>", rings.len() + 1),
                "give its <LowerTheta> and <UpperTheta>",
            );
        };
        let nominal = number(Some(block), "Theta")?;
        let Some(count) = number(Some(block), "nPhis")? else {
            return fail(
                format!("ring {} has no <nPhis>", rings.len() + 1),
                "give its number of patches",
            );
        };
        if !(1.0..=1e6).contains(&count) || count.fract() != 0.0 {
            return fail(
                format!("nPhis is {count}"),
                "give a whole number of patches from 1 to 1000000",
            );
        }
        rings.push(Ring {
            lower_deg,
            upper_deg,
            nominal_deg: nominal.unwrap_or(if count == 1.0 {
                0.0
            } else {
                0.5 * (lower_deg + upper_deg)
            }),
            count: count as usize,
        });
    }
    Basis::from_rings(name, rings).map_err(|e| {
        Error::format(
            place(decoder.faults.bytes, node.at, node.name),
            e.to_string(),
            "correct the listing",
        )
    })
}

/// Incident and outgoing basis, and what is to be warned of.
pub(super) type Settled = (Arc<Basis>, Arc<Basis>, Option<String>);

/// Why a pair of bases could not be found.
pub(super) struct Misfit {
    pub what: String,
    pub remedy: String,
}

/// Incident and outgoing basis for a count of values, and a warning where the names do not tell them.
pub(super) fn settle(
    incident: &Choice,
    outgoing: &Choice,
    hint: Option<&Arc<Basis>>,
    count: usize,
) -> std::result::Result<Settled, Misfit> {
    let fits = |i: &Basis, o: &Basis| i.len().checked_mul(o.len()) == Some(count);
    // What the person says goes first.
    if let Some(hint) = hint.filter(|h| fits(h, h)) {
        return Ok((hint.clone(), hint.clone(), None));
    }
    let (i, o) = (incident.basis().or(hint), outgoing.basis().or(hint));
    if let (Some(i), Some(o)) = (i, o)
        && fits(i, o)
    {
        return Ok((i.clone(), o.clone(), unlisted(incident, outgoing)));
    }
    // A listing that is wrong under a standard name, or the old count of a standard name.
    let other = |choice: &Choice| match choice {
        Choice::Listed {
            instead_of: Some(basis),
            ..
        } => Some(basis.clone()),
        _ => None,
    };
    if let (Some(i), Some(o)) = (other(incident), other(outgoing))
        && fits(&i, &o)
    {
        let warning = format!(
            "for {} the standard {:?} is used, not its listing",
            counted(count, "value"),
            i.name()
        );
        return Ok((i, o, Some(warning)));
    }
    if incident.may_be_another()
        && outgoing.may_be_another()
        && let Some(basis) = standard().into_iter().find(|b| fits(b, b))
    {
        let mut facts = incident.words();
        if outgoing.words() != facts {
            facts = format!("{facts}, {}", outgoing.words());
        }
        let warning = format!("{facts}; for {count} values the standard {:?} is used", basis.name());
        let basis = Arc::new(basis);
        return Ok((basis.clone(), basis, Some(warning)));
    }
    Err(match (i, o) {
        (Some(i), Some(o)) => Misfit {
            what: format!(
                "{} where {} × {} = {} belong for {:?} and {:?}",
                counted(count, "value"),
                o.len(),
                i.len(),
                i.len().saturating_mul(o.len()),
                o.name(),
                i.name()
            ),
            remedy: "get the whole file again, or correct the angle basis".into(),
        },
        _ => Misfit {
            what: format!(
                "{}, and no standard basis has {}",
                if incident.basis().is_none() { incident } else { outgoing }.words(),
                counted(count, "value")
            ),
            remedy: "list it under <DataDefinition>, or say which with `clerestory convert IN OUT --assume-basis \
                     klems-full`"
                .into(),
        },
    })
}

/// A warning of listings that a file lacks.
fn unlisted(incident: &Choice, outgoing: &Choice) -> Option<String> {
    let mut names = [incident, outgoing].into_iter().filter_map(Choice::unlisted);
    let first = names.next()?;
    Some(match names.find(|n| *n != first) {
        None => format!(
            "the listing of angle basis {first:?} (<AngleBasis>) is missing; the standard basis of that name is used"
        ),
        Some(other) => format!(
            "the listings of angle bases {first:?} and {other:?} (<AngleBasis>) are missing; the standard bases of those \
             names are used"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(basis: Basis) -> Choice {
        Choice::Named(Arc::new(basis))
    }

    fn listed(basis: Basis) -> Choice {
        Choice::Listed {
            basis: Arc::new(basis),
            instead_of: None,
        }
    }

    fn warning(incident: &Choice, outgoing: &Choice, hint: Option<Basis>, count: usize) -> Option<String> {
        let settled = settle(incident, outgoing, hint.map(Arc::new).as_ref(), count);
        settled.unwrap_or_else(|m| panic!("{} ({})", m.what, m.remedy)).2
    }

    #[test]
    fn a_missing_listing_is_told() {
        let (full, quarter) = (Basis::klems_full, Basis::klems_quarter);
        assert_eq!(warning(&listed(quarter()), &listed(quarter()), None, 41 * 41), None);
        let one = warning(&named(quarter()), &named(quarter()), None, 41 * 41).unwrap();
        assert!(
            one.contains("the listing of angle basis \"LBNL/Klems Quarter\" (<AngleBasis>) is missing"),
            "{one}"
        );
        assert_eq!(
            warning(&named(quarter()), &listed(full()), None, 41 * 145),
            Some(one.clone())
        );
        assert_eq!(warning(&listed(full()), &named(quarter()), None, 41 * 145), Some(one));
        let both = warning(&named(full()), &named(quarter()), None, 41 * 145).unwrap();
        assert!(
            both.contains("\"LBNL/Klems Full\" and \"LBNL/Klems Quarter\""),
            "{both}"
        );
        // What the person says needs no listing.
        assert_eq!(
            warning(&named(quarter()), &named(quarter()), Some(quarter()), 41 * 41),
            None
        );
    }

    #[test]
    fn another_basis_is_told_in_words() {
        let unnamed = Choice::Unknown(String::new());
        assert_eq!(
            warning(&unnamed, &unnamed, None, 41 * 41).unwrap(),
            "the angle basis has no name; for 1681 values the standard \"LBNL/Klems Quarter\" is used"
        );
        let full = named(Basis::klems_full());
        assert_eq!(
            warning(&full, &full, None, 41 * 41).unwrap(),
            "angle basis \"LBNL/Klems Full\" (145 patches) is not listed; for 1681 values the standard \"LBNL/Klems \
             Quarter\" is used"
        );
        let misfit = settle(&unnamed, &unnamed, None, 1).unwrap_err();
        assert_eq!(
            misfit.what,
            "the angle basis has no name, and no standard basis has 1 value"
        );
    }
}
