//! From the values of plans to a better plan.

use crate::curve::Curve;
use crate::settings::{Method, Settings};
use msk_physics::scalar::Real;

/// The plan that is followed, and where others are looked for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Search {
    /// The best plan that has been played: the mean of good plans can be a bad one.
    pub plan: Curve,
    /// The middle of what good plans have in common.
    pub mean: Curve,
    /// Standard deviation of each of its values.
    pub deviation: Vec<f64>,
}

impl Search {
    /// Begins with a plan, and the deviation of the settings.
    pub fn around(plan: Curve, settings: &Settings) -> Self {
        Self { deviation: vec![settings.noise; plan.values.len()], mean: plan.clone(), plan }
    }

    /// Goes on by `share` of the horizon.
    pub fn advance(&mut self, share: f64, rest: f64, settings: &Settings) {
        self.plan.advance(share, rest, settings.decay);
        self.mean.advance(share, rest, settings.decay);
        // What has been learnt of a knot belongs to the time where it was: half of it is forgotten.
        self.deviation.iter_mut().for_each(|deviation| *deviation = 0.5 * (*deviation + settings.noise));
    }

    /// Takes the values of plans, the first of which is the present one.
    pub fn update(&mut self, plans: &[Curve], values: &[f64], settings: &Settings) {
        let mut order: Vec<usize> = (0..plans.len()).collect();
        // Earlier plans win ties.
        order.sort_by(|&a, &b| values[b].total_cmp(&values[a]).then(a.cmp(&b)));
        let elites = &order[..settings.elites.min(order.len())];
        let Some(&best) = order.first() else { return };
        self.plan.clone_from(&plans[best]);
        match settings.method {
            Method::Predictive => self.mean.clone_from(&plans[best]),
            Method::Cem => self.combine(plans, elites, &by_rank(elites.len()), settings),
            Method::Mppi => {
                let weights = weights(&order, values, settings.temperature);
                self.combine(plans, &order, &weights, settings);
            }
        }
    }

    /// The weighted mean of plans, and their deviation from it.
    fn combine(&mut self, plans: &[Curve], chosen: &[usize], weights: &[f64], settings: &Settings) {
        let sum: f64 = weights.iter().sum();
        for (place, (mean, deviation)) in self.mean.values.iter_mut().zip(&mut self.deviation).enumerate() {
            let weighted = || chosen.iter().zip(weights).map(|(&plan, weight)| (plans[plan].values[place], weight / sum));
            *mean = weighted().map(|(value, weight)| weight * value).sum();
            let variance: f64 = weighted().map(|(value, weight)| weight * (value - *mean) * (value - *mean)).sum();
            let found = libm::sqrt(variance).at_least(settings.least_noise).at_most(settings.noise);
            *deviation = 0.5 * (*deviation + found);
        }
    }
}

/// Weights of so many plans in their order, as Hansen and Ostermeier (2001) have them: the first counts most.
fn by_rank(count: usize) -> Vec<f64> {
    (0..count).map(|rank| libm::log(count as f64 + 0.5) - libm::log(rank as f64 + 1.0)).collect()
}

/// Weights of plans in their order: exponential in what they are worth less than the best, in units of how far the better half spreads.
fn weights(order: &[usize], values: &[f64], temperature: f64) -> Vec<f64> {
    let best = values[order[0]];
    let spread = (best - values[order[order.len() / 2]]).at_least(1e-9);
    order.iter().map(|&plan| libm::exp((values[plan] - best) / (temperature * spread))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proposal::Noise;
    use msk_runtime::episode::{EpisodeKey, Stream};

    fn begun(value: f64, width: usize, settings: &Settings) -> Search {
        Search::around(Curve::constant(value, settings.knots + 1, width, settings.interpolation), settings)
    }

    /// Rounds on a value whose best plan is 0.5 in each entry.
    fn found(method: Method) -> f64 {
        let settings = Settings { method, knots: 3, elites: 4, ..Settings::default() };
        let mut search = begun(0.0, 4, &settings);
        let value = |plan: &Curve| -plan.values.iter().map(|value| (value - 0.5) * (value - 0.5)).sum::<f64>();
        let mut stream = Stream::new(EpisodeKey { seed: 1, episode: 2 }, "search");
        for _ in 0..60 {
            let noise = Noise { colour: 0.5, part: 0.5 };
            let mut plans = vec![search.plan.clone(), search.mean.clone()];
            plans.extend((2..24).map(|index| {
                noise.propose(index, if index % 2 == 0 { &search.plan } else { &search.mean }, &search.deviation, &mut stream)
            }));
            let values: Vec<f64> = plans.iter().map(value).collect();
            search.update(&plans, &values, &settings);
        }
        -value(&search.plan)
    }

    #[test]
    fn every_method_finds_the_top_of_a_hill() {
        for method in [Method::Predictive, Method::Cem, Method::Mppi] {
            let rest = found(method);
            assert!(rest < 0.12, "{method:?}: {rest} of 4");
        }
    }

    #[test]
    fn predictive_sampling_keeps_the_present_plan_unless_another_is_better() {
        let settings = Settings { method: Method::Predictive, ..Settings::default() };
        let mut search = begun(0.0, 2, &settings);
        let plans = [search.plan.clone(), begun(0.5, 2, &settings).mean];
        search.update(&plans, &[1.0, 1.0], &settings);
        assert_eq!(search.plan, plans[0]);
        search.update(&plans, &[1.0, 1.1], &settings);
        assert_eq!(search.plan, plans[1]);
    }
}
