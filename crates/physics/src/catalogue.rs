//! The catalogue: every law with its equation, parameters and source, as data.

use crate::{Parameter, effects, equation_of_state, flow_stress, friction, heat, process};

/// One entry of the catalogue, whatever its kind.
#[derive(Debug, Clone, Copy)]
pub struct CatalogueEntry {
    /// `flow_stress`, `equation_of_state`, `effects`, `friction`, `process` or `heat`.
    pub kind: &'static str,
    /// Name in the scenario file.
    pub key: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// The equation in one line.
    pub equation: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Where it holds and what it neglects.
    pub validity: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
}

/// All entries, ordered by kind.
#[must_use]
pub fn entries() -> Vec<CatalogueEntry> {
    let flow = flow_stress::LAWS.iter().map(|law| CatalogueEntry {
        kind: "flow_stress",
        key: law.key,
        title: law.title,
        equation: law.equation,
        source: law.source,
        validity: law.validity,
        parameters: law.parameters,
    });
    let equation_of_state = equation_of_state::LAWS.iter().map(|law| CatalogueEntry {
        kind: "equation_of_state",
        key: law.key,
        title: law.title,
        equation: law.equation,
        source: law.source,
        validity: law.validity,
        parameters: law.parameters,
    });
    let effects = effects::EFFECTS.iter().map(|effect| CatalogueEntry {
        kind: "effects",
        key: effect.key,
        title: effect.title,
        equation: effect.equation,
        source: effect.source,
        validity: effect.validity,
        parameters: effect.parameters,
    });
    let friction = friction::LAWS.iter().map(|law| CatalogueEntry {
        kind: "friction",
        key: law.key,
        title: law.title,
        equation: law.equation,
        source: law.source,
        validity: law.validity,
        parameters: law.parameters,
    });
    let process = process::ENTRIES.iter().map(|entry| CatalogueEntry {
        kind: "process",
        key: entry.key,
        title: entry.title,
        equation: entry.equation,
        source: entry.source,
        validity: entry.validity,
        parameters: entry.parameters,
    });
    let heat = CatalogueEntry {
        kind: "heat",
        key: "heat",
        title: "Plastic and friction heat, conduction",
        equation: "rho cp dT/dt = div(k grad T) + beta sigma_y eps_p_dot; \
                   friction heat: eta tau v_slip to the workpiece",
        source: "Taylor and Quinney, Proc. R. Soc. A 143 (1934) 307-326",
        validity: "constant shares; conduction by Fourier's law",
        parameters: heat::PARAMETERS,
    };
    flow.chain(equation_of_state)
        .chain(effects)
        .chain(friction)
        .chain(process)
        .chain([heat])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_entry_says_what_it_is_and_where_it_comes_from() {
        for entry in entries() {
            for text in [entry.key, entry.title, entry.equation, entry.source, entry.validity] {
                assert!(!text.is_empty(), "{}: an empty text", entry.key);
            }
            for parameter in entry.parameters {
                assert!(!parameter.meaning.is_empty() && !parameter.source.is_empty());
                if let Some(default) = parameter.default {
                    assert!(parameter.range.contains(default), "{}: default", parameter.key);
                }
            }
        }
    }

    #[test]
    fn keys_are_unique_and_in_snake_case() {
        let entries = entries();
        for (index, entry) in entries.iter().enumerate() {
            assert!(!entries[..index].iter().any(|other| other.key == entry.key));
            assert!(entry.key.chars().all(|c| c.is_ascii_lowercase() || c == '_'));
        }
    }

    #[test]
    fn no_parameter_has_a_name_that_means_two_things() {
        const BANNED: [&str; 10] = ["h", "m", "n", "A", "B", "C", "T", "alpha", "gamma", "mu"];
        for entry in entries() {
            for parameter in entry.parameters {
                assert!(!BANNED.contains(&parameter.key), "{}", parameter.key);
            }
        }
    }
}
