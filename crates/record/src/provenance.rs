//! Where a result comes from.

/// 0 °C in K.
pub const ZERO_CELSIUS: f64 = 273.15;

/// Everything needed to obtain the same result again.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Provenance {
    /// The scenario file, word for word, and with it every material it refers to.
    pub scenario_text: String,
    /// File stem of the scenario.
    pub scenario_name: String,
    /// Title of the scenario.
    pub title: String,
    /// Version of sphcut that computed the run.
    pub version: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Effects and laws with their resolved parameters: name and description.
    pub effects: Vec<(String, String)>,
    /// The resolved scenario, key by key.
    pub settings: Vec<Setting>,
    /// What the scenario's author was warned of.
    pub warnings: Vec<String>,
}

/// One resolved key of the scenario.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Setting {
    /// Section of the file, e.g. `tool.friction`.
    pub section: String,
    /// Key in that section.
    pub key: String,
    /// The value as the user wrote it, or the default in the same notation.
    pub text: String,
    /// The value in SI units, as text.
    pub value: String,
    /// Its SI unit; empty where it has none.
    pub unit: String,
}

/// The unit in which people read temperatures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TemperatureUnit {
    /// Degrees Celsius, with kelvin beside them.
    Celsius,
    /// Kelvin.
    Kelvin,
}

impl TemperatureUnit {
    /// Its sign.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Celsius => "\u{b0}C",
            Self::Kelvin => "K",
        }
    }

    /// A temperature in K in this unit.
    #[must_use]
    pub fn of(self, kelvin: f64) -> f64 {
        match self {
            Self::Celsius => kelvin - ZERO_CELSIUS,
            Self::Kelvin => kelvin,
        }
    }

    /// `442 °C (715 K)`.
    #[must_use]
    pub fn shown(self, kelvin: f64) -> String {
        match self {
            Self::Celsius => format!("{:.0} \u{b0}C ({kelvin:.0} K)", self.of(kelvin)),
            Self::Kelvin => format!("{kelvin:.0} K"),
        }
    }
}

impl Provenance {
    /// What the resolved scenario has under `key` of `section`.
    #[must_use]
    pub fn setting(&self, section: &str, key: &str) -> Option<&Setting> {
        self.settings.iter().find(|setting| setting.section == section && setting.key == key)
    }

    /// The same as a number in SI units, where it is one.
    #[must_use]
    pub fn number(&self, section: &str, key: &str) -> Option<f64> {
        self.setting(section, key)?.value.parse().ok()
    }

    /// The unit in which the author of the scenario writes temperatures.
    #[must_use]
    pub fn temperature_unit(&self) -> TemperatureUnit {
        let mut texts = self.settings.iter().filter(|s| s.key == "temperature").map(|s| &s.text);
        if texts.any(|text| text.ends_with("degC")) {
            TemperatureUnit::Celsius
        } else {
            TemperatureUnit::Kelvin
        }
    }

    /// Why `other` is not the same run as `self`, in words for the user; `None` if it is.
    #[must_use]
    pub fn difference(&self, other: &Self) -> Option<String> {
        if self.version != other.version {
            return Some(format!(
                "it was computed by version {} of sphcut and this is version {}",
                other.version, self.version
            ));
        }
        if self.scenario_text != other.scenario_text {
            return Some(first_difference(&self.scenario_text, &other.scenario_text));
        }
        if self.seed != other.seed {
            return Some(format!("its seed is {} and the scenario says {}", other.seed, self.seed));
        }
        if self.settings != other.settings || self.effects != other.effects {
            return Some(
                "the scenario's text is the same, but it resolves to other values (a material \
                 file changed?)"
                    .to_owned(),
            );
        }
        None
    }
}

fn first_difference(now: &str, before: &str) -> String {
    let number = now.lines().zip(before.lines()).take_while(|(now, before)| now == before).count();
    let line = |text: &str| text.lines().nth(number).unwrap_or("(end of file)").to_owned();
    format!(
        "the scenario has changed in line {}: it was `{}` and is now `{}`",
        number + 1,
        line(before).trim(),
        line(now).trim()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_changed_line_is_named() {
        let before =
            Provenance { scenario_text: "a = 1\nb = 2\n".to_owned(), ..Default::default() };
        let now = Provenance { scenario_text: "a = 1\nb = 3\n".to_owned(), ..before.clone() };
        let difference = now.difference(&before).unwrap();
        assert!(difference.contains("line 2") && difference.contains("`b = 2`"), "{difference}");
        assert_eq!(now.difference(&now.clone()), None);
    }
}
