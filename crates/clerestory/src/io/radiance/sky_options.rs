//! The options of `gensky` and `gendaylit`.

use super::sky::{CieSky, Gendaylit, Gensky, Site, SkyModel, Supply, When};
use super::words::shown;
use crate::error::{Error, Result};

/// Time zones that the programs know, by the meridian (degrees west).
const ZONES: [(&str, f64); 27] = [
    ("YST", 135.0),
    ("YDT", 120.0),
    ("PST", 120.0),
    ("PDT", 105.0),
    ("MST", 105.0),
    ("MDT", 90.0),
    ("CST", 90.0),
    ("CDT", 75.0),
    ("EST", 75.0),
    ("EDT", 60.0),
    ("AST", 60.0),
    ("ADT", 45.0),
    ("NST", 52.5),
    ("NDT", 37.5),
    ("GMT", 0.0),
    ("BST", -15.0),
    ("CET", -15.0),
    ("CEST", -30.0),
    ("EET", -30.0),
    ("EEST", -45.0),
    ("GST", -60.0),
    ("GDT", -75.0),
    ("IST", -82.5),
    ("IDT", -97.5),
    ("JST", -135.0),
    ("NZST", -180.0),
    ("NZDT", -195.0),
];

/// Where the programs are by default: Berkeley.
const BERKELEY: Site = Site {
    latitude_deg: 37.815_214,
    longitude_deg: 122.040_010,
    meridian_deg: 120.0,
};

/// The sky of a command line; the program's name is its first word.
pub(super) fn sky(words: &[String]) -> Result<SkyModel> {
    let Some((program, words)) = words.split_first() else {
        return Err(Error::Argument("an empty command (remove the exclamation mark)".into()));
    };
    let mut options = Options {
        words: words.iter(),
        option: String::new(),
    };
    let read = if program == "gensky" {
        gensky(&mut options).map(SkyModel::Gensky)
    } else {
        gendaylit(&mut options).map(SkyModel::Gendaylit)
    };
    read.map_err(|e| e.within(&format!("{program}: ")))
}

struct Options<'a> {
    words: std::slice::Iter<'a, String>,
    /// The latest one, for messages.
    option: String,
}

impl Options<'_> {
    fn word(&mut self, what: &str) -> Result<&str> {
        let option = &self.option;
        self.words
            .next()
            .map(String::as_str)
            .ok_or_else(|| Error::Argument(format!("{} is missing (add it)", named(option, what))))
    }

    fn number(&mut self, what: &str, [low, high]: [f64; 2]) -> Result<f64> {
        let option = self.option.clone();
        let word = self.word(what)?;
        match word.parse::<f64>() {
            Ok(value) if (low..=high).contains(&value) => Ok(value),
            _ => {
                let range = match (low.is_finite(), high.is_finite()) {
                    (true, true) => format!("give a number from {low} to {high}"),
                    (true, false) => format!("give a number of {low} or more"),
                    _ => "give a number".into(),
                };
                Err(Error::Argument(format!(
                    "{} is {} ({range})",
                    named(&option, what),
                    shown(word)
                )))
            }
        }
    }

    fn positive(&mut self, what: &str) -> Result<f64> {
        self.number(what, [0.0, f64::MAX])
    }

    fn whole(&mut self, what: &str, most: f64) -> Result<u32> {
        let value = self.number(what, [0.0, most])?;
        if value.fract() != 0.0 {
            return Err(Error::Argument(format!("{what} is {value} (give a whole number)")));
        }
        Ok(value as u32)
    }

    /// Month, day and hour, or the sun's angles; and the meridian of a time zone that stands with the hour.
    fn when(&mut self) -> Result<(When, Option<f64>)> {
        let first = self.word("the month, or -ang,")?;
        if first == "-ang" {
            let sun = When::Sun {
                altitude_deg: self.number("the altitude", [-90.0, 90.0])?,
                azimuth_deg: self.number("the azimuth", [-360.0, 360.0])?,
            };
            return Ok((sun, None));
        }
        let month = first.parse().ok().filter(|m| (1..=12).contains(m));
        let Some(month) = month else {
            return Err(Error::Argument(format!(
                "{} as the month (give 1 to 12, or -ang with the sun's altitude and azimuth)",
                shown(first)
            )));
        };
        let day = self.whole("the day", 31.0)?.max(1);
        let word = self.word("the hour")?;
        let (hour, solar, zone) = hour(word)?;
        let time = When::Time {
            month,
            day,
            hour,
            solar,
        };
        Ok((time, zone))
    }

    /// Options that both programs have; whether it is one of them.
    fn common(&mut self, option: &str, site: &mut Site, ground: &mut f64, year: &mut Option<u32>) -> Result<bool> {
        match option {
            "-a" => site.latitude_deg = self.number("", [-90.0, 90.0])?,
            "-o" => site.longitude_deg = self.number("", [-360.0, 360.0])?,
            "-m" => site.meridian_deg = self.number("", [-360.0, 360.0])?,
            "-g" => *ground = self.number("", [0.0, 1.0])?,
            "-y" => *year = Some(self.whole("", 2050.0)?),
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn next(&mut self) -> Option<String> {
        let option = self.words.next()?;
        self.option.clone_from(option);
        Some(option.clone())
    }
}

/// An argument in messages.
fn named(option: &str, what: &str) -> String {
    let both = format!("{option} {what}");
    both.trim().to_owned()
}

/// `10:30`, `10.5`, `10:30EST`; with a plus sign in front it is solar time.
fn hour(word: &str) -> Result<(f64, bool, Option<f64>)> {
    let fail = || {
        Error::Argument(format!(
            "{} as the hour (give for example 10.5, 10:30, 10:30EST, or +10:30 for solar time)",
            shown(word)
        ))
    };
    let (solar, rest) = word.strip_prefix('+').map_or((false, word), |rest| (true, rest));
    let letters = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len());
    let (digits, zone) = rest.split_at(letters);
    let hour = match digits.split_once(':') {
        Some((hours, minutes)) => {
            let [hours, minutes] = [hours, minutes].map(|w| w.parse::<u32>().ok());
            let (Some(hours), Some(minutes @ 0..60)) = (hours, minutes) else {
                return Err(fail());
            };
            f64::from(hours) + f64::from(minutes) / 60.0
        }
        None => digits.parse::<f64>().map_err(|_| fail())?,
    };
    if !(0.0..=24.0).contains(&hour) || (solar && !zone.is_empty()) {
        return Err(fail());
    }
    if zone.is_empty() {
        return Ok((hour, solar, None));
    }
    match ZONES.iter().find(|(name, _)| *name == zone) {
        Some((_, meridian)) => Ok((hour, false, Some(*meridian))),
        None => Err(Error::Argument(format!(
            "{} as a time zone (there are {})",
            shown(zone),
            ZONES.map(|(name, _)| name).join(", ")
        ))),
    }
}

fn unknown(option: &str, known: &str) -> Error {
    Error::Unsupported(format!(
        "option {} (there are {known}; run the program yourself and put its output into the file)",
        shown(option)
    ))
}

fn gensky(options: &mut Options<'_>) -> Result<Gensky> {
    let (when, zone) = options.when()?;
    let mut read = Gensky {
        when,
        year: None,
        site: BERKELEY,
        sky: CieSky::Clear,
        sun: true,
        ground_reflectance: 0.2,
        turbidity: 2.45,
        zenith_radiance: None,
        sky_irradiance: None,
        sun_radiance: None,
        sun_irradiance: None,
    };
    while let Some(option) = options.next() {
        match option.as_str() {
            "-s" | "+s" => (read.sky, read.sun) = (CieSky::Clear, option == "+s"),
            "-i" | "+i" => (read.sky, read.sun) = (CieSky::Intermediate, option == "+i"),
            "-c" | "+c" => (read.sky, read.sun) = (CieSky::Overcast, false),
            "-u" | "+u" => (read.sky, read.sun) = (CieSky::Uniform, false),
            "-t" => read.turbidity = options.positive("")?,
            "-b" => (read.zenith_radiance, read.sky_irradiance) = (Some(options.positive("")?), None),
            "-B" => (read.sky_irradiance, read.zenith_radiance) = (Some(options.positive("")?), None),
            "-r" => (read.sun_radiance, read.sun_irradiance) = (Some(options.positive("")?), None),
            "-R" => (read.sun_irradiance, read.sun_radiance) = (Some(options.positive("")?), None),
            other => {
                let (site, ground) = (&mut read.site, &mut read.ground_reflectance);
                if !options.common(other, site, ground, &mut read.year)? {
                    return Err(unknown(other, "-s +s -i +i -c -u -a -o -m -y -g -t -b -B -r -R"));
                }
            }
        }
    }
    // The zone of the hour counts before -m.
    read.site.meridian_deg = zone.unwrap_or(read.site.meridian_deg);
    Ok(read)
}

fn gendaylit(options: &mut Options<'_>) -> Result<Gendaylit> {
    let (when, zone) = options.when()?;
    let (mut site, mut ground, mut year) = (BERKELEY, 0.2, None);
    let (mut supply, mut sun, mut output, mut interval) = (None, true, 0, None);
    let mut meridian = false;
    while let Some(option) = options.next() {
        match option.as_str() {
            "-s" | "+s" => sun = option == "+s",
            // No warnings.
            "-w" => {}
            "-O" => output = options.whole("", 2.0)?,
            "-i" => interval = Some(options.positive("")?),
            "-P" => {
                supply = Some(Supply::Perez {
                    clearness: options.positive("epsilon")?,
                    brightness: options.positive("delta")?,
                });
            }
            "-E" => {
                supply = Some(Supply::Global {
                    global: options.positive("")?,
                });
            }
            "-W" | "-L" | "-G" => {
                let (direct, diffuse) = (options.positive("direct")?, options.positive("diffuse")?);
                supply = Some(match option.as_str() {
                    "-W" => Supply::Irradiance { direct, diffuse },
                    "-L" => Supply::Illuminance { direct, diffuse },
                    _ => Supply::Horizontal { direct, diffuse },
                });
            }
            other => {
                if !options.common(other, &mut site, &mut ground, &mut year)? {
                    return Err(unknown(other, "-P -W -L -G -E -O -s -a -o -m -y -g -i -w"));
                }
                meridian |= other == "-m";
            }
        }
    }
    // The program has no use for the zone.
    if let (Some(zone), false) = (zone, meridian) {
        return Err(Error::Argument(format!(
            "a time zone without -m, which would count as the zone of Berkeley (add -m {zone})"
        )));
    }
    let Some(supply) = supply else {
        return Err(Error::Argument(
            "how much light there is is missing (add -W, -L, -G, -E or -P)".into(),
        ));
    };
    Ok(Gendaylit {
        when,
        year,
        site,
        supply,
        sun,
        ground_reflectance: ground,
        output,
        interval_minutes: interval,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<SkyModel> {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        sky(&words)
    }

    #[test]
    fn options_are_read_into_their_fields() {
        let Ok(SkyModel::Gensky(sky)) = read("gensky 3 20 10:30EDT -m 75 -o 73.96 -a 40.78 +i -g .3 -B 100 -y 2020")
        else {
            panic!("a sky")
        };
        let when = When::Time {
            month: 3,
            day: 20,
            hour: 10.5,
            solar: false,
        };
        assert_eq!((sky.when, sky.year), (when, Some(2020)));
        assert_eq!((sky.site.meridian_deg, sky.site.longitude_deg), (60.0, 73.96));
        assert_eq!((sky.sky, sky.sun), (CieSky::Intermediate, true));
        assert_eq!((sky.ground_reflectance, sky.sky_irradiance), (0.3, Some(100.0)));
        let Ok(SkyModel::Gensky(sky)) = read("gensky -ang 30 -10 -c -b 5") else {
            panic!("a sky")
        };
        assert_eq!(
            (sky.sky, sky.sun, sky.zenith_radiance),
            (CieSky::Overcast, false, Some(5.0))
        );
        let Ok(SkyModel::Gendaylit(sky)) = read("gendaylit 3 20 +10.5 -m 75 -W 706 162 -O 1 -s -w") else {
            panic!("a sky")
        };
        let supply = Supply::Irradiance {
            direct: 706.0,
            diffuse: 162.0,
        };
        assert_eq!((sky.supply, sky.output, sky.sun), (supply, 1, false));
        assert!(matches!(sky.when, When::Time { solar: true, .. }));
    }

    #[test]
    fn faulty_options_are_told() {
        for (line, text) in [
            ("gensky 13 1 12", "gensky: \"13\" as the month"),
            ("gensky 6 40 12", "the day is \"40\""),
            ("gensky 6 21", "the hour is missing"),
            ("gensky 6 21 10:5x", "\"x\" as a time zone"),
            ("gensky 6 21 10:75", "\"10:75\" as the hour"),
            ("gensky 6 21 noon", "as the hour"),
            ("gensky 6 21 12 -a", "-a is missing"),
            ("gensky 6 21 12 -a 100", "-a is \"100\""),
            ("gensky 6 21 12 -q", "option \"-q\""),
            ("gendaylit 6 21 12", "how much light"),
            ("gendaylit 6 21 12 -W 100", "diffuse is missing"),
            ("gendaylit 6 21 12EST -W 100 100", "add -m 75"),
            ("gendaylit 6 21 12 -W 100 100 -O 3", "\"3\""),
            ("gensky -ang 100 0", "the altitude"),
        ] {
            let told = read(line).unwrap_err().to_string();
            assert!(told.contains(text), "{line}: {told}");
        }
    }
}
