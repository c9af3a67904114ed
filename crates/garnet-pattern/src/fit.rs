//! Whom a garment fits.

use crate::jeans::LEAST_FORK;
use crate::reference::REFERENCE;
use crate::wearer::{Measures, WIDEST_BAND};
use crate::{GarmentKind, Parameters, Size};

/// Any ease above the least is allowed.
const ANY: f64 = f64::INFINITY;

/// How much wider a garment is than its wearer at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ease {
    /// The girth: `chest`, `waist`, `hip` or `thigh`.
    pub place: &'static str,
    /// The girth of the garment over that of the wearer, less 1.
    pub share: f64,
    /// What the place allows.
    pub allowed: [f64; 2],
}

impl Ease {
    /// Whether the ease is allowed.
    pub fn is_allowed(&self) -> bool {
        (self.allowed[0]..=self.allowed[1]).contains(&self.share)
    }
}

/// How a garment fits a wearer.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The eases that decide.
    pub eases: Vec<Ease>,
}

impl Fit {
    /// Whether all eases are allowed.
    pub fn fits(&self) -> bool {
        self.eases.iter().all(Ease::is_allowed)
    }

    /// The ease at a place, if it decides.
    pub fn ease(&self, place: &str) -> Option<f64> {
        let found = self.eases.iter().find(|ease| ease.place == place);
        found.map(|ease| ease.share)
    }
}

/// A girth of a garment as its pattern has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finished {
    /// The girth of the body that it goes round: `chest`, `waist`, `hip` or `thigh`; of shirts,
    /// their hem is the hip.
    pub place: &'static str,
    /// In metres, without stretch.
    pub girth: f64,
    /// Where a waistband lies.
    pub band: Option<Band>,
}

/// Where a waistband lies on its wearer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The share of the way from the hip up to the waist.
    pub above_hip: f64,
    /// It is cut for this share of the hip at most: under a belly that is wider.
    pub widest: f64,
}

impl Parameters {
    /// The girths of the garment, cut to the measures `cut`, where the pattern has them exactly:
    /// the hip of a dress depends on its flare.
    pub fn finished(&self, cut: &Measures) -> Vec<Finished> {
        let at = |place, girth| Finished {
            place,
            girth,
            band: None,
        };
        match self.garment() {
            GarmentKind::Tshirt | GarmentKind::Sweater => {
                let chest = cut.chest * (1.0 + self.at("chest-ease"));
                vec![
                    at("chest", chest),
                    at("waist", chest * (1.0 + self.at("waist-shape"))),
                    at("hip", chest * (1.0 + self.at("hem-flare"))),
                ]
            }
            GarmentKind::Dress => vec![
                at("chest", cut.chest * (1.0 + self.at("chest-ease"))),
                at("waist", cut.waist * (1.0 + self.at("waist-ease"))),
            ],
            GarmentKind::Jeans => {
                let height = self.band_height(cut);
                let band = Band {
                    above_hip: (height - cut.hip_height) / (cut.waist_height - cut.hip_height),
                    widest: WIDEST_BAND,
                };
                let waist = cut.band_girth(height) * (1.0 + self.at("waist-ease"));
                let hip = cut.hip * (1.0 + self.at("hip-ease"));
                let thigh = cut.thigh * (1.0 + self.at("thigh-ease"));
                vec![
                    Finished {
                        band: Some(band),
                        ..at("waist", waist)
                    },
                    at("hip", hip),
                    at("thigh", thigh.max(0.5 * hip + LEAST_FORK * cut.hip)),
                ]
            }
        }
    }

    /// How high the middle of the waistband of jeans lies on a body, in metres.
    fn band_height(&self, body: &Measures) -> f64 {
        let rise = self.at("rise") * body.stature / REFERENCE.measures.stature;
        body.inseam + rise - 0.5 * self.at("waistband")
    }

    /// How the garment, cut to the measures `cut`, fits a wearer.
    ///
    /// A T-shirt fits from 6 to 36 % more than the chest, a sweater from 8 to 45 %; both stretch
    /// over waist and hip by 2 % at most. A dress fits from 1 to 26 % at the chest and from 1 to 45
    /// % at the waist. Jeans must hold: from -4 % to 6 % under the waistband, or of 97 % of the hip
    /// under a belly. On tighter bodies the simulated drapes of many poses fold through themselves
    /// or are strained by a fifth and more.
    #[expect(
        clippy::missing_panics_doc,
        reason = "a garment has the girths of its pattern"
    )]
    pub fn fit(&self, cut: &Measures, wearer: &Measures) -> Fit {
        let place = |place, garment: f64, body: f64, low, high| Ease {
            place,
            share: garment / body - 1.0,
            allowed: [low, high],
        };
        let finished = self.finished(cut);
        let girth = |of: &str| {
            let found = finished.iter().find(|finished| finished.place == of);
            found.expect("the pattern has this girth").girth
        };
        let eases = match self.garment() {
            kind @ (GarmentKind::Tshirt | GarmentKind::Sweater) => {
                let chest_range = match kind {
                    GarmentKind::Tshirt => [0.06, 0.36],
                    _ => [0.08, 0.45],
                };
                let [low, high] = chest_range;
                let mut eases = vec![
                    place("chest", girth("chest"), wearer.chest, low, high),
                    place("waist", girth("waist"), wearer.waist, -0.02, ANY),
                ];
                let length = self.length_from_neck(cut).unwrap_or(0.0);
                if wearer.neck_height - length < wearer.hip_height {
                    eases.push(place("hip", girth("hip"), wearer.hip, -0.02, ANY));
                }
                eases
            }
            GarmentKind::Dress => vec![
                place("chest", girth("chest"), wearer.chest, 0.01, 0.26),
                place("waist", girth("waist"), wearer.waist, 0.01, 0.45),
                {
                    let least = cut.hip * (1.0 + self.at("hip-ease"));
                    place("hip", least, wearer.hip, 0.0, ANY)
                },
            ],
            GarmentKind::Jeans => {
                let band = wearer.band_girth(self.band_height(wearer));
                // The legs of wide hips are wider.
                let least = cut.thigh * (1.0 + self.at("thigh-ease"));
                vec![
                    place("waist", girth("waist"), band, -0.04, 0.06),
                    place("hip", girth("hip"), wearer.hip, 0.0, 0.30),
                    place("thigh", least, wearer.thigh, 0.0, 0.60),
                ]
            }
        };
        Fit { eases }
    }

    /// How far below the neck a shirt, cut to the measures `cut`, ends, in metres; none of other
    /// garments.
    pub fn length_from_neck(&self, cut: &Measures) -> Option<f64> {
        let is_shirt = matches!(self.garment(), GarmentKind::Tshirt | GarmentKind::Sweater);
        is_shirt.then(|| self.at("length") * cut.stature / REFERENCE.measures.stature)
    }

    /// How much longer the legs of jeans, cut to the measures `cut`, are than those of a wearer,
    /// from the crotch to the soles, in metres; none of other garments.
    pub fn legs_below_soles(&self, cut: &Measures, wearer: &Measures) -> Option<f64> {
        let is_jeans = self.garment() == GarmentKind::Jeans;
        let scale = cut.inseam / REFERENCE.measures.inseam;
        is_jeans.then(|| self.at("inseam") * scale - wearer.inseam)
    }

    /// Sizes, the one that fits a wearer best first: those that fit before the others, and of these
    /// the ones whose eases, and of trousers legs, are nearer to those of a garment made to
    /// measure.
    pub fn by_fit(&self, sizes: &[Size], wearer: &Measures) -> Vec<Size> {
        let wanted = self.fit(wearer, wearer);
        let rank = |size: &Size| {
            let found = self.fit(&size.measures(), wearer);
            let pairs = found.eases.iter().zip(&wanted.eases);
            let miss: f64 = pairs.map(|(a, b)| (a.share - b.share).powi(2)).sum();
            let legs = match size {
                Size::Trousers { .. } => size.measures().inseam / wearer.inseam - 1.0,
                _ => 0.0,
            };
            (!found.fits(), miss + legs * legs)
        };
        let ranked = sizes.iter().map(|size| (rank(size), *size));
        let mut sizes: Vec<((bool, f64), Size)> = ranked.collect();
        sizes.sort_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        sizes.into_iter().map(|(_, size)| size).collect()
    }

    /// The sizes that it is cut in: of trousers by waist and inner leg.
    pub fn sizes(&self) -> Vec<Size> {
        match self.garment() {
            GarmentKind::Jeans => Size::trousers(),
            _ => Size::ALL.to_vec(),
        }
    }

    /// The size that fits a wearer best: of those that fit, the one whose eases are nearest to
    /// those of a garment made to measure.
    pub fn best_size(&self, wearer: &Measures) -> Option<Size> {
        let first = self.by_fit(&self.sizes(), wearer).first().copied();
        first.filter(|size| self.fit(&size.measures(), wearer).fits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn made_to_measure_always_fits() {
        for kind in GarmentKind::ALL {
            for size in Size::ALL {
                let body = size.measures();
                let fit = kind.parameters().fit(&body, &body);
                assert!(fit.fits(), "{kind} {size} {fit:?}");
            }
        }
    }

    #[test]
    fn a_tshirt_fits_from_six_per_cent_more_to_a_third_more() {
        let tshirt = GarmentKind::Tshirt.parameters();
        let cut = Size::M.measures();
        let mut wearer = cut;
        let garment = cut.chest * (1.0 + tshirt.at("chest-ease"));
        for (ease, fits) in [(0.05, false), (0.07, true), (0.35, true), (0.37, false)] {
            wearer.chest = garment / (1.0 + ease);
            assert_eq!(tshirt.fit(&cut, &wearer).fits(), fits, "{ease}");
        }
    }

    #[test]
    fn jeans_of_who_has_a_belly_are_cut_for_the_hip_that_holds_them() {
        let jeans = GarmentKind::Jeans.parameters();
        let mut wearer = Size::L.measures();
        wearer.waist = 1.1 * wearer.hip;
        let height = wearer.inseam + jeans.at("rise") - 0.5 * jeans.at("waistband");
        assert!(wearer.trunk_girth(height) > wearer.hip);
        assert!(wearer.band_girth(height) < wearer.hip);
        assert!(jeans.fit(&wearer, &wearer).fits());
    }

    #[test]
    fn trousers_are_found_by_waist_and_inner_leg() {
        let jeans = GarmentKind::Jeans.parameters();
        for size in Size::trousers().into_iter().step_by(7) {
            let sizes = jeans.by_fit(&Size::trousers(), &size.measures());
            assert_eq!(sizes[0], size, "then {}", sizes[1]);
        }
    }

    #[test]
    fn the_best_size_is_that_of_the_measures() {
        for kind in GarmentKind::ALL {
            for size in Size::ALL {
                let parameters = kind.parameters();
                let best = parameters.best_size(&size.measures());
                if kind == GarmentKind::Jeans {
                    assert!(matches!(best, Some(Size::Trousers { .. })), "{best:?}");
                } else {
                    assert_eq!(best, Some(size), "{kind}");
                }
                let sizes = parameters.by_fit(&Size::ALL, &size.measures());
                assert_eq!(sizes.len(), Size::ALL.len());
                let place = |size: Size| Size::ALL.iter().position(|&other| other == size);
                let [first, second] = [size, sizes[1]].map(|size| place(size).unwrap());
                assert_eq!(
                    first.abs_diff(second),
                    1,
                    "{kind} {size}: then {}",
                    sizes[1]
                );
            }
        }
    }
}
