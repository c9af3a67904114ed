//! The paper's tables with ours beside them.
//!
//! Numbers of the paper: *Gundogdu et al., TPAMI 2020*, tables 1 to 10; ours: reports in a folder.
//! Distances are in millimetres, angles in degrees; what nobody has measured is a dash.

use std::{collections::BTreeMap, error::Error, fs, path::Path};

use serde_json::Value;

use super::{
    markdown::Grid,
    read,
    scores::{Eval, EvalMethod, Scores, Setting},
};
use crate::{
    compare::{self, Comparison},
    sewing::{self, Sewing},
};

/// The garments in the order of the tables.
const GARMENTS: [&str; 4] = ["tshirt", "sweater", "dress", "jeans"];

/// The garments as tables name them.
const TITLES: [&str; 4] = ["T-shirt", "sweater", "dress", "jeans"];

/// A variant, its name in tables, and the paper's figures for each garment.
type Architecture = (&'static str, &'static str, [[f64; 2]; 4]);

/// The paper's `E_dist` in millimetres and `E_norm` in degrees of tables 1 and 8, of each garment.
const ARCHITECTURES: [Architecture; 7] = [
    (
        "dqs",
        "skinning (DQS)",
        [[99.8, 30.74], [64.7, 24.64], [147.9, 28.21], [114.3, 22.0]],
    ),
    (
        "naive",
        "GarNet-Naive",
        [[7.3, 11.28], [10.3, 11.3], [11.9, 8.92], [7.0, 8.83]],
    ),
    (
        "global",
        "GarNet-Global",
        [[5.7, 8.44], [9.3, 10.54], [11.3, 7.83], [4.2, 5.18]],
    ),
    (
        "local",
        "GarNet-Local",
        [[5.6, 8.34], [8.5, 10.39], [10.6, 7.8], [4.1, 5.1]],
    ),
    (
        "local-rq",
        "GarNet-Local-RQ",
        [[6.3, 7.79], [11.0, 9.7], [11.5, 7.15], [5.3, 5.08]],
    ),
    (
        "local-mc",
        "GarNet-Local-MC",
        [[6.9, 7.66], [8.8, 8.88], [11.6, 6.85], [4.5, 4.79]],
    ),
    (
        "local-mcrq",
        "GarNet-Local-MCRQ",
        [[6.5, 7.47], [11.4, 9.54], [12.1, 7.18], [5.6, 4.85]],
    ),
];

/// Ways that the paper has not.
const OURS: [(&str, &str); 5] = [
    ("warp", "warp: skinning and the change of shape"),
    ("pose-space", "`pose-space`: what GarNet starts from"),
    ("fast settled", "`fast`"),
    ("balanced settled", "`balanced`"),
    ("accurate settled", "`accurate`"),
];

/// Table 3: Global-Params of each garment.
const PARAMS: [[f64; 2]; 4] = [[5.4, 8.4], [7.7, 9.76], [10.5, 7.47], [4.4, 5.36]];

/// Table 4: normalised distance and angle, on shirts of Wang et al. 2018.
const SEWING: [(&str, &str, &str); 3] = [
    ("GarNet-Local", "0.43", "7.34"),
    ("GarNet-Global", "0.48", "7.75"),
    ("Wang et al. 2018", "3.01", "-"),
];

/// Table 5: what was left out of the loss, and the paper's distance and angle.
const LOSSES: [(&str, &str, [f64; 2]); 6] = [
    ("only-pen", "vertex, penetration", [4.9, 10.01]),
    ("no-normal", "without normal", [5.1, 9.06]),
    ("no-pen", "without penetration", [4.8, 7.7]),
    ("no-bend", "without bending", [4.8, 7.91]),
    ("local", "all", [4.2, 7.34]),
    ("local-rq", "all and RQ", [4.5, 7.2]),
];

/// Table 6: neighborhoods of `L_RQ`.
const NEIGHBORHOODS: [(&str, &str, [f64; 2]); 5] = [
    ("rq-8", "8", [4.3, 7.51]),
    ("rq-16", "16", [4.4, 7.44]),
    ("rq-32", "32", [4.7, 7.42]),
    ("rq-8-16", "8 and 16", [4.3, 7.38]),
    ("local-rq", "8, 16 and 32", [4.5, 7.2]),
];

/// Table 7: `L_MC` and `L_RQ`, of each garment.
const CURVATURE: [(&str, &str, [[f64; 2]; 4]); 4] = [
    (
        "local",
        "GarNet-Local",
        [[0.14, 0.23], [0.13, 0.82], [0.06, 0.52], [0.29, 0.07]],
    ),
    (
        "local-rq",
        "GarNet-Local-RQ",
        [[0.13, 0.09], [0.11, 0.27], [0.04, 0.15], [0.29, 0.07]],
    ),
    (
        "local-mc",
        "GarNet-Local-MC",
        [[0.11, 0.26], [0.08, 0.64], [0.03, 0.46], [0.28, 0.067]],
    ),
    (
        "local-mcrq",
        "GarNet-Local-MCRQ",
        [[0.12, 0.10], [0.09, 0.28], [0.037, 0.17], [0.30, 0.066]],
    ),
];

/// Table 9: distance, angle, `L_MC` and `L_RQ`.
const KINDS: [(&str, &str, [f64; 4]); 3] = [
    ("local-umc", "GarNet-Local-UMC", [6.1, 8.25, 0.14, 0.23]),
    ("local-mc", "GarNet-Local-MC", [6.9, 7.66, 0.11, 0.26]),
    ("local-rq", "GarNet-Local-RQ", [6.3, 7.79, 0.13, 0.09]),
];

/// Table 10: T-shirt and sweater on bodies of another family, trained on them.
const FAMILY: [(&str, &str, [[f64; 3]; 2]); 2] = [
    (
        "local",
        "GarNet-Local",
        [[5.3, 8.23, 0.044], [6.1, 8.11, 0.047]],
    ),
    (
        "local-rq",
        "GarNet-Local-RQ",
        [[4.6, 6.56, 0.025], [5.6, 6.66, 0.031]],
    ),
];

/// The protocols.
const PROTOCOLS: [&str; 2] = ["seen-poses", "unseen-sequences"];

/// All reports of a folder.
#[derive(Debug, Default)]
struct Reports {
    /// By protocol, garment and method.
    methods: BTreeMap<(String, String, String), EvalMethod>,
    /// Scenes and vertices of a protocol and garment.
    scenes: BTreeMap<(String, String), [usize; 2]>,
    families: BTreeMap<String, Comparison>,
    sewing: Option<Sewing>,
}

/// The text with its tables.
pub(super) fn filled(folder: &Path, text: &Path) -> Result<String, Box<dyn Error>> {
    let reports = Reports::read(folder)?;
    let source =
        fs::read_to_string(text).map_err(|error| format!("`{}`: {error}", text.display()))?;
    let mut filled = String::new();
    for (number, line) in source.lines().enumerate() {
        let name = line
            .strip_prefix("{{")
            .and_then(|line| line.strip_suffix("}}"));
        if let Some(name) = name {
            let table = reports.table(name).ok_or_else(|| {
                let line = number + 1;
                format!(
                    "`{}`, line {line}: no table is called `{name}`",
                    text.display()
                )
            })?;
            filled += &table;
        } else {
            filled += line;
            filled.push('\n');
        }
    }
    Ok(filled)
}

impl Reports {
    fn read(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let mut reports = Self::default();
        let entries =
            fs::read_dir(folder).map_err(|error| format!("`{}`: {error}", folder.display()))?;
        let mut paths: Vec<_> = entries
            .map(|entry| Ok(entry?.path()))
            .collect::<Result<_, std::io::Error>>()?;
        paths.retain(|path| path.extension().is_some_and(|end| end == "json"));
        paths.sort();
        for path in paths {
            let value: Value = read(&path)?;
            match value["schema"].as_str() {
                Some("garnet.eval/1") => reports.add_eval(serde_json::from_value(value)?),
                Some(compare::SCHEMA) => {
                    let found: Comparison = serde_json::from_value(value)?;
                    reports.families.insert(found.garment.clone(), found);
                }
                Some(sewing::SCHEMA) => reports.sewing = Some(serde_json::from_value(value)?),
                _ => return Err(format!("`{}` is no report of these", path.display()).into()),
            }
        }
        Ok(reports)
    }

    fn add_eval(&mut self, report: Eval) {
        let Setting {
            garment,
            protocol,
            scenes,
            vertices,
            ..
        } = report.setting;
        let protocol = protocol.unwrap_or_default();
        let place = (protocol.clone(), garment.clone());
        self.scenes.insert(place, [scenes, vertices]);
        for method in report.methods {
            let key = (protocol.clone(), garment.clone(), method.name.clone());
            self.methods.insert(key, method);
        }
    }

    fn of(&self, protocol: &str, garment: &str, method: &str) -> Option<&EvalMethod> {
        let key = (protocol.to_owned(), garment.to_owned(), method.to_owned());
        self.methods.get(&key)
    }

    fn table(&self, name: &str) -> Option<String> {
        let grid = match name {
            "scenes" => self.scenes(),
            "time" => self.time(),
            "parameters" => self.parameters(),
            "sewing" => self.sewing(),
            "losses" => self.varied(&LOSSES, "loss"),
            "neighborhoods" => self.varied(&NEIGHBORHOODS, "neighbours"),
            "curvature" => self.curvature(),
            "kinds" => self.kinds(),
            "family" => self.family(),
            _ => {
                let garment = name.strip_prefix("architectures ")?;
                self.architectures(GARMENTS.iter().position(|&known| known == garment)?)
            }
        };
        Some(grid.text())
    }

    /// How many scenes of the test split there are, of how many vertices.
    fn scenes(&self) -> Grid {
        let mut grid = Grid::new(&["test split", "seen poses", "unseen sequences"]);
        for (garment, title) in GARMENTS.iter().zip(TITLES) {
            let mut row = vec![title.to_owned()];
            for protocol in PROTOCOLS {
                let sizes = self
                    .scenes
                    .get(&(protocol.to_owned(), (*garment).to_owned()));
                row.push(sizes.map_or_else(dash, |[scenes, vertices]| {
                    format!("{scenes} of {vertices} vertices")
                }));
            }
            grid.push(row);
        }
        grid
    }

    /// Tables 1 and 8.
    fn architectures(&self, garment: usize) -> Grid {
        let mut grid = Grid::new(&[
            "",
            "paper",
            "seen poses",
            "inside %",
            "untangled",
            "unseen sequences",
            "inside %",
            "untangled",
        ]);
        let ours = OURS.iter().map(|&(name, title)| (name, title, None));
        let papers = ARCHITECTURES
            .iter()
            .map(|(name, title, of)| (*name, *title, Some(of[garment])));
        for (name, title, paper) in papers.chain(ours) {
            let [seen, unseen] =
                PROTOCOLS.map(|protocol| self.of(protocol, GARMENTS[garment], name));
            if paper.is_none() && seen.is_none() && unseen.is_none() {
                continue;
            }
            let before = |of: Option<&EvalMethod>| of.map_or_else(dash, |of| nearness(&of.scores));
            let after = |of: Option<&EvalMethod>| {
                let untangled = of.and_then(|of| of.untangled.as_ref());
                untangled.map_or_else(dash, |untangled| nearness(&untangled.scores))
            };
            let inside = |of: Option<&EvalMethod>| of.map_or_else(dash, |of| inside(&of.scores));
            let mut row = vec![
                title.to_owned(),
                paper.map_or_else(dash, |[distance, normal]| pair(distance, normal)),
            ];
            for of in [seen, unseen] {
                row.extend([before(of), inside(of), after(of)]);
            }
            grid.push(row);
        }
        grid
    }

    /// Table 2, of the T-shirt.
    fn time(&self) -> Grid {
        let mut grid = Grid::new(&["", "paper ms", "ours ms"]);
        let papers = [
            ("local", "GarNet-Local", "68"),
            ("global", "GarNet-Global", "59"),
            ("naive", "GarNet-Naive", "0.2"),
        ];
        let ours = OURS.iter().map(|&(name, title)| (name, title, "-"));
        for (name, title, paper) in papers.into_iter().chain(ours) {
            let Some(of) = self.of(PROTOCOLS[1], "tshirt", name) else {
                continue;
            };
            let medians = of.seconds.values().filter_map(|times| times.median);
            let seconds: f64 = medians.sum();
            let whole = format!("{:.1}", 1e3 * seconds);
            grid.push(vec![title.to_owned(), paper.to_owned(), whole]);
        }
        grid
    }

    /// Table 3.
    fn parameters(&self) -> Grid {
        let mut grid = Grid::new(&["", "", "Local", "Global", "Global-Params"]);
        for (number, (garment, title)) in GARMENTS.iter().zip(TITLES).enumerate() {
            let local = ARCHITECTURES[3].2[number];
            let global = ARCHITECTURES[2].2[number];
            let paper =
                [local, global, PARAMS[number]].map(|[distance, normal]| pair(distance, normal));
            let mut row = vec![title.to_owned(), "paper".to_owned()];
            row.extend(paper);
            grid.push(row);
            for protocol in PROTOCOLS {
                let names = ["local", "global", "global-params"];
                let found = names.map(|name| self.of(protocol, garment, name));
                if found[2].is_none() {
                    continue;
                }
                let mut row = vec![title.to_owned(), protocol.replace('-', " ")];
                row.extend(found.map(|of| of.map_or_else(dash, |of| nearness(&of.scores))));
                grid.push(row);
            }
        }
        grid
    }

    /// Table 4.
    fn sewing(&self) -> Grid {
        let mut grid = Grid::new(&["", "normalised distance %", "E_dist mm", "E_norm °"]);
        for (name, percent, normal) in SEWING {
            let name = format!("{name}, the paper's");
            grid.push(vec![name, percent.to_owned(), dash(), normal.to_owned()]);
        }
        for method in self.sewing.iter().flat_map(|sewing| &sewing.methods) {
            grid.push(vec![
                format!("`{}`", method.name),
                format!("{:.2}", method.percent),
                format!("{:.1}", 1e3 * method.distance),
                format!("{:.1}", method.normal.to_degrees()),
            ]);
        }
        grid
    }

    /// Tables 5 and 6, of the T-shirt in seen poses.
    fn varied(&self, rows: &[(&str, &str, [f64; 2])], head: &str) -> Grid {
        let mut grid = Grid::new(&[head, "paper", "ours", "L_RQ", "inside %"]);
        for &(name, title, [distance, normal]) in rows {
            let of = self.of(PROTOCOLS[0], "tshirt", name).map(|of| of.scores);
            grid.push(vec![
                title.to_owned(),
                pair(distance, normal),
                of.as_ref().map_or_else(dash, nearness),
                of.and_then(|of| of.rayleigh)
                    .map_or_else(dash, |value| format!("{value:.2e}")),
                of.as_ref().map_or_else(dash, inside),
            ]);
        }
        grid
    }

    /// Table 7.
    fn curvature(&self) -> Grid {
        let mut grid = Grid::new(&["", "", "paper", "seen poses", "unseen sequences"]);
        for (number, (garment, garment_title)) in GARMENTS.iter().zip(TITLES).enumerate() {
            for (name, title, paper) in &CURVATURE {
                let found = PROTOCOLS.map(|protocol| self.of(protocol, garment, name));
                if found.iter().all(Option::is_none) {
                    continue;
                }
                let [mean, rayleigh] = paper[number];
                let mut row = vec![
                    garment_title.to_owned(),
                    (*title).to_owned(),
                    format!("{mean} / {rayleigh}"),
                ];
                row.extend(found.map(|of| of.map_or_else(dash, |of| curvatures(&of.scores))));
                grid.push(row);
            }
        }
        grid
    }

    /// Table 9, of the T-shirt in seen poses.
    fn kinds(&self) -> Grid {
        let mut grid = Grid::new(&["", "paper", "L_MC / L_RQ", "ours", "L_MC / L_RQ"]);
        for (name, title, [distance, normal, mean, rayleigh]) in KINDS {
            let of = self.of(PROTOCOLS[0], "tshirt", name).map(|of| of.scores);
            grid.push(vec![
                title.to_owned(),
                pair(distance, normal),
                format!("{mean} / {rayleigh}"),
                of.as_ref().map_or_else(dash, nearness),
                of.as_ref().map_or_else(dash, curvatures),
            ]);
        }
        grid
    }

    /// Table 10.
    fn family(&self) -> Grid {
        let mut grid = Grid::new(&["", "", "bodies", "E_dist / E_norm", "L_RQ", "farthest body"]);
        for (number, (garment, title)) in GARMENTS.iter().zip(TITLES).enumerate() {
            for (_, name, paper) in FAMILY {
                if let Some([distance, normal, rayleigh]) = paper.get(number) {
                    grid.push(vec![
                        title.to_owned(),
                        format!("{name}, the paper's"),
                        "432".to_owned(),
                        pair(*distance, *normal),
                        rayleigh.to_string(),
                        dash(),
                    ]);
                }
            }
            let found = self.families.get(*garment);
            for method in found.into_iter().flat_map(|found| &found.methods) {
                grid.push(vec![
                    title.to_owned(),
                    format!("`{}`", method.name),
                    method.scenes.to_string(),
                    pair(1e3 * method.distance, method.normal.to_degrees()),
                    format!("{:.1e}", method.rayleigh),
                    format!("{:.1}", 1e3 * method.worst),
                ]);
            }
        }
        grid
    }
}

/// Distance in millimetres and angle in degrees.
fn nearness(scores: &Scores) -> String {
    let both = scores.distance.zip(scores.normal);
    both.map_or_else(dash, |(distance, normal)| {
        pair(1e3 * distance, normal.to_degrees())
    })
}

/// `L_MC` and `L_RQ`.
fn curvatures(scores: &Scores) -> String {
    let both = scores.mean_curvature.zip(scores.rayleigh);
    both.map_or_else(dash, |(mean, rayleigh)| {
        format!("{mean:.1} / {rayleigh:.2e}")
    })
}

/// The share of vertices inside, in per cent.
fn inside(scores: &Scores) -> String {
    let share = scores.inside;
    share.map_or_else(dash, |share| format!("{:.1}", 1e2 * share))
}

fn pair(distance: f64, normal: f64) -> String {
    format!("{distance:.1} / {normal:.1}")
}

fn dash() -> String {
    "-".to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVAL: &str = r#"{"schema": "garnet.eval/1", "garment": "tshirt", "vertices": 1500,
        "dataset": "data", "split": "test", "threads": 2,
        "protocol": "seen-poses", "scenes": 400, "methods": [
        {"name": "local", "scores": {"distance": 0.0042, "normal": 0.1, "inside": 0.004,
            "rayleigh": 1e-4, "mean_curvature": 36.0, "stretch_p99": 1.12},
         "untangled": {"scores": {"distance": 0.0041, "normal": 0.1, "inside": 0.0,
            "rayleigh": 1e-4, "mean_curvature": 36.0, "stretch_p99": 1.12}, "inside": 0},
         "seconds": {"warp": {"median": 0.001}, "network": {"median": 0.02}, "untangle": {"median": 0.01}}}]}"#;

    #[test]
    fn a_text_has_its_tables() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("seen.json"), EVAL).unwrap();
        let text = folder.path().join("text.md");
        fs::write(&text, "# Head\n\n{{architectures tshirt}}\nend\n").unwrap();
        let filled = filled(folder.path(), &text).unwrap();
        let row = filled
            .lines()
            .find(|line| line.contains("GarNet-Local "))
            .unwrap();
        let fields: Vec<&str> = row.split('|').map(str::trim).collect();
        let expected = [
            "GarNet-Local",
            "5.6 / 8.3",
            "4.2 / 5.7",
            "0.4",
            "4.1 / 5.7",
            "-",
            "-",
            "-",
        ];
        assert_eq!(fields[1..9], expected);
        assert!(
            filled.starts_with("# Head\n\n|") && filled.ends_with("|\nend\n"),
            "{filled}"
        );
        let all = "{{scenes}}\n{{time}}\n{{parameters}}\n{{losses}}\n{{neighborhoods}}\n{{curvature}}\n{{kinds}}\n{{family}}\n";
        fs::write(&text, all).unwrap();
        let filled = super::filled(folder.path(), &text).unwrap();
        assert!(filled.contains("400 of 1500 vertices"), "{filled}");
        assert!(filled.contains("| all "), "{filled}");
    }

    #[test]
    fn the_committed_page_is_what_is_printed() {
        let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
        let folder = models.join("results");
        let printed = filled(&folder, &folder.join("text.md")).unwrap();
        let committed = fs::read_to_string(models.join("RESULTS.md")).unwrap();
        assert!(
            printed == committed,
            "print `models/RESULTS.md` anew, as its head says"
        );
    }

    #[test]
    fn what_is_no_table_and_no_report_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let text = folder.path().join("text.md");
        fs::write(&text, "{{no such}}\n").unwrap();
        let error = filled(folder.path(), &text).unwrap_err().to_string();
        assert!(
            error.contains("line 1") && error.contains("no such"),
            "{error}"
        );
        fs::write(folder.path().join("other.json"), "{}").unwrap();
        let error = filled(folder.path(), &text).unwrap_err().to_string();
        assert!(error.contains("other.json"), "{error}");
    }
}
