//! Which of two layouts is better: what users who were trained on each allow to say, and what not.

use std::fmt;

use myo_tasks::{FlatTask, Step, Task};
use myo_train::session::Trend;
use myo_train::statistics::{Sample, rank_sum, welch};
use myo_train::{Evaluation, PpoConfig, RunError, RunFolder};
use serde::{Deserialize, Serialize};

use crate::RunDescription;

/// Probability of claiming any difference of a layout from itself.
const CLAIM: f64 = 0.05;

/// Share of a time or an effort below which a difference may be one of training: users of the same layout at their plateau
/// may still become faster by so much.
const TRAINING: f64 = 0.03;

/// The same for shares of episodes.
const TRAINING_SUCCESS: f64 = 0.01;

/// From so many users of each on, ranks are compared instead of means: users fall into different habits, so that their times
/// form clusters, in which a test that believes in one spread sees little. Ranks of fewer can never be told apart with certainty.
const RANKS_FROM: usize = 5;

/// One trained user.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TrainedUser {
    /// How well it does.
    pub evaluation: Evaluation,
    /// What the last doubling of its training brought and more would, if that can be told.
    pub trend: Option<Trend>,
}

/// Users of one layout, trained in the same way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Group {
    /// What people call it.
    pub name: String,
    /// What they do, on which body, trained by which version.
    pub run: RunDescription,
    /// Settings of the learner.
    pub ppo: PpoConfig,
    /// At least one.
    pub users: Vec<TrainedUser>,
}

impl Group {
    /// The users of these runs, at least one, all of the layout of the first.
    ///
    /// # Errors
    /// A run cannot be read, was not evaluated, or is of another task or other settings than the first.
    pub fn of_runs(name: String, runs: &[RunFolder]) -> Result<Self, RunError> {
        let [first, ..] = runs else { return Err(RunError::Incomparable { reason: "there is no run".into() }) };
        let (run, ppo) = (RunDescription::of(first)?, first.config().ppo.clone());
        let mut users = Vec::new();
        for folder in runs {
            let path = folder.path().display();
            let Some(evaluation) = folder.evaluation()? else {
                return Err(RunError::Incomparable {
                    reason: format!("{path} is not evaluated yet; go on with it first"),
                });
            };
            if RunDescription::of(folder)?.layouts() != run.layouts() || folder.config().ppo != ppo {
                let reason = format!("{path} is of another task or other settings than {}", first.path().display());
                return Err(RunError::Incomparable { reason });
            }
            let checkpoint = folder.latest_checkpoint()?.checkpoint;
            users.push(TrainedUser { evaluation, trend: checkpoint.and_then(|checkpoint| checkpoint.trend()) });
        }
        Ok(Self { name, run, ppo, users })
    }
}

/// A quantity that layouts are compared by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Share of episodes with every target done.
    Success,
    /// Mean duration of an episode, in seconds.
    EpisodeLengthS,
    /// Mean squared muscle control.
    Effort,
    /// Share of the strength of all muscles that fatigues in an episode.
    Fatigue,
}

impl Quantity {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Success, Self::EpisodeLengthS, Self::Effort, Self::Fatigue];

    /// Of one user.
    pub fn of(self, user: &TrainedUser) -> Option<f64> {
        match self {
            Self::Success => user.evaluation.success,
            Self::EpisodeLengthS => user.evaluation.episode_length_s,
            Self::Effort => user.evaluation.effort,
            Self::Fatigue => user.evaluation.fatigue,
        }
    }

    /// Name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Success => "success",
            Self::EpisodeLengthS => "time per episode",
            Self::Effort => "effort",
            Self::Fatigue => "fatigue per episode",
        }
    }

    /// A value with its unit, for people.
    pub fn show(self, value: f64) -> String {
        match self {
            Self::Success => format!("{:.1} %", 100.0 * value),
            Self::EpisodeLengthS => format!("{value:.2} s"),
            Self::Effort => format!("{value:.4}"),
            Self::Fatigue => format!("{:.3} %", 100.0 * value),
        }
    }

    /// What the one with the lower (false) or higher (true) value is called.
    fn praise(self, is_higher: bool) -> &'static str {
        match (self, is_higher) {
            (Self::Success, true) => "succeeds more often",
            (Self::Success, false) => "succeeds less often",
            (Self::EpisodeLengthS, true) => "is slower",
            (Self::EpisodeLengthS, false) => "is faster",
            (Self::Effort, true) => "takes more effort",
            (Self::Effort, false) => "takes less effort",
            (Self::Fatigue, true) => "is more tiring",
            (Self::Fatigue, false) => "is less tiring",
        }
    }

    /// The greatest difference that may be one of training.
    fn resolution(self, mean: f64) -> f64 {
        match self {
            Self::Success => TRAINING_SUCCESS,
            Self::EpisodeLengthS | Self::Effort | Self::Fatigue => TRAINING * mean.abs(),
        }
    }
}

/// What can be said of a difference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The second is higher.
    Higher,
    /// The second is lower.
    Lower,
    /// There is one, but more training may bring as much.
    WithinTraining,
    /// None was found.
    NoDifference,
    /// Too few users to tell.
    Unknown,
}

/// Two layouts in one quantity: over users, not over episodes, for users differ more than chance within an episode.
#[derive(Clone, Debug, Serialize)]
pub struct Difference {
    /// Which quantity.
    pub quantity: Quantity,
    /// Mean of the users of the first layout.
    pub first: f64,
    /// Mean of the users of the second layout.
    pub second: f64,
    /// Second less first.
    pub difference: f64,
    /// 95 % confidence interval of it (Welch 1947, doi 10.1093/biomet/34.1-2.28); none with a single user.
    pub interval: Option<[f64; 2]>,
    /// Probability of a difference as large between layouts that do not differ, if it can be told: by the ranks of users, from
    /// five of each on, else by Welch's test.
    pub p_value: Option<f64>,
    /// What can be said.
    pub verdict: Verdict,
}

/// All that can be said of two layouts.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Names of the layouts.
    pub names: [String; 2],
    /// Users of each.
    pub users: [usize; 2],
    /// A row per quantity that both have.
    pub differences: Vec<Difference>,
    /// What weakens the comparison, a sentence each.
    pub caveats: Vec<String>,
}

impl Comparison {
    /// Compares users of two layouts. A difference is claimed where it is unlikely to be chance (Holm 1979,
    /// Scandinavian Journal of Statistics 6, 65-70, over all quantities together) and larger than what training may still bring.
    pub fn new(first: &Group, second: &Group) -> Self {
        let mut differences: Vec<Difference> =
            Quantity::ALL.iter().filter_map(|&quantity| difference(quantity, first, second)).collect();
        judge(&mut differences);
        Self {
            names: [first, second].map(|group| group.name.clone()),
            users: [first, second].map(|group| group.users.len()),
            differences,
            caveats: caveats(first, second),
        }
    }

    /// The verdict on every quantity, a sentence each.
    pub fn sentences(&self) -> impl Iterator<Item = String> + '_ {
        self.differences.iter().map(|difference| difference.sentence(&self.names))
    }
}

impl fmt::Display for Comparison {
    /// Verdicts, then caveats, a line each.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for line in self.sentences().chain(self.caveats.iter().cloned()) {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

fn values(quantity: Quantity, group: &Group) -> Vec<f64> {
    group.users.iter().filter_map(|user| quantity.of(user)).collect()
}

fn difference(quantity: Quantity, first: &Group, second: &Group) -> Option<Difference> {
    let (a, b) = (values(quantity, first), values(quantity, second));
    let (mean_a, mean_b) = (Sample::of(&a)?.mean, Sample::of(&b)?.mean);
    let test = welch(&a, &b);
    let ranks = (a.len().min(b.len()) >= RANKS_FROM).then(|| rank_sum(&a, &b));
    Some(Difference {
        quantity,
        first: mean_a,
        second: mean_b,
        difference: mean_b - mean_a,
        interval: test.map(|test| test.interval),
        p_value: ranks.or(test.map(|test| test.p_value)),
        verdict: Verdict::Unknown,
    })
}

/// Holm's procedure: the least p-value must be below a share of what is allowed, the next below a larger one, and so on until
/// the first that is not.
fn judge(differences: &mut [Difference]) {
    let mut order: Vec<usize> = (0..differences.len()).filter(|&k| differences[k].p_value.is_some()).collect();
    let p = |differences: &[Difference], k: usize| differences[k].p_value.unwrap_or(1.0);
    order.sort_by(|&j, &k| p(differences, j).total_cmp(&p(differences, k)));
    let tests = order.len();
    let mut is_claimed = true;
    for (rank, k) in order.into_iter().enumerate() {
        is_claimed &= p(differences, k) < CLAIM / (tests - rank) as f64;
        let Difference { quantity, first, second, difference, .. } = differences[k];
        let is_large = difference.abs() > quantity.resolution(0.5 * (first + second));
        differences[k].verdict = match (is_claimed, is_large) {
            (false, _) => Verdict::NoDifference,
            (true, false) => Verdict::WithinTraining,
            (true, true) if difference > 0.0 => Verdict::Higher,
            (true, true) => Verdict::Lower,
        };
    }
}

/// Why an interval without zero is no difference.
const CHANCE: &str =
    "; that leaves out 0, as one of several quantities easily does by chance, so more users are needed to tell";

impl Difference {
    /// Whether its own interval leaves out zero.
    fn seems_to_differ(&self) -> bool {
        self.interval.is_some_and(|[low, high]| low > 0.0 || high < 0.0)
    }

    fn sentence(&self, [first, second]: &[String; 2]) -> String {
        let show = |value| self.quantity.show(value);
        let (name, a, b) = (self.quantity.name(), show(self.first), show(self.second));
        let between = self.interval.map_or(String::new(), |[low, high]| {
            format!(" (95 % interval of the difference: {} to {})", show(low), show(high))
        });
        match self.verdict {
            Verdict::Higher | Verdict::Lower => {
                let praise = self.quantity.praise(self.verdict == Verdict::Higher);
                format!("{second} {praise} than {first}: {name} {b} against {a}{between}")
            }
            Verdict::WithinTraining => format!(
                "no difference worth the name in {name}: {first} {a}, {second} {b}{between}; more training may bring as much"
            ),
            Verdict::NoDifference => {
                let chance = if self.seems_to_differ() { CHANCE } else { "" };
                format!("no difference found in {name}: {first} {a}, {second} {b}{between}{chance}")
            }
            Verdict::Unknown => {
                format!(
                    "{name}: {first} {a}, {second} {b}; with a single user of a layout nobody can tell whether that is chance"
                )
            }
        }
    }
}

/// What weakens a comparison.
fn caveats(first: &Group, second: &Group) -> Vec<String> {
    let both = [first, second];
    let mut caveats = Vec::new();
    let (a, b) = (&first.run, &second.run);
    if (&a.task.model, &a.model) != (&b.task.model, &b.model) {
        caveats.push(format!(
            "bodies differ ({} and {}): a difference may be the body's, not the layout's",
            a.task.model, b.task.model
        ));
    }
    if a.version != b.version {
        caveats.push(format!(
            "trained by different versions ({} and {}): a difference may be the program's",
            a.version, b.version
        ));
    }
    if kinds(&a.task) != kinds(&b.task) {
        caveats.push(
            "the tasks ask for different things (pointing and pressing): times are those of different actions".into(),
        );
    }
    let counts = both.map(|group| flat(&group.run.task).steps.len());
    if counts[0] != counts[1] {
        caveats.push(format!(
            "the tasks have {} and {} targets: whole tasks are compared, not targets",
            counts[0], counts[1]
        ));
    }
    for group in both {
        let layouts = group.run.layouts().len();
        if layouts > 1 {
            let name = &group.name;
            caveats.push(format!("each user of {name} learned {layouts} layouts: its numbers are means over them"));
        }
    }
    if a.task.reward != b.task.reward {
        caveats.push("users were rewarded differently: they may have tried for different things".into());
    }
    if (a.goal(), &first.ppo) != (b.goal(), &second.ppo) {
        caveats.push("users were trained with different goals or settings: a difference may be one of training".into());
    }
    for group in both {
        let unfinished = |user: &&TrainedUser| user.trend.is_none_or(|trend| !trend.is_plateau());
        let count = group.users.iter().filter(unfinished).count();
        if count > 0 {
            let all = group.users.len();
            caveats.push(format!(
                "{count} of {all} users of {} had not finished learning: a difference may be one of training; train them with --until plateau",
                group.name
            ));
        }
    }
    caveats
}

/// Which kinds of targets a task has: pointing, pressing.
fn kinds(task: &Task) -> [bool; 2] {
    let is_dwell = |step: &Step| step.dwell_s().is_some();
    let steps = flat(task).steps;
    [steps.iter().any(is_dwell), !steps.iter().all(is_dwell)]
}

/// A task that was trained, so that it is right, written out.
fn flat(task: &Task) -> FlatTask {
    task.flat().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use myo_tasks::preset;
    use myo_train::session::{Goal, Until};

    use myo_train::session::Change;

    use super::*;
    use crate::Device;

    const NONE: Change = Change { episode_time: 0.0, success: 0.0, episode_return: 0.0 };
    const SETTLED: Trend = Trend { env_steps: 1, since: 0, last_doubling: NONE, four_times: NONE };

    fn user(success: f64, seconds: f64, effort: f64) -> TrainedUser {
        let evaluation = serde_json::json!({
            "success": success, "success_interval": null, "episodes": 1000, "targets": [],
            "final_distance_m": null, "final_distance_m_interval": null, "effort": effort, "effort_interval": null,
            "episode_length_s": seconds, "episode_length_s_interval": null, "return": null, "return_interval": null,
        });
        TrainedUser { evaluation: serde_json::from_value(evaluation).unwrap(), trend: Some(SETTLED) }
    }

    /// Users who all succeed, with these times per episode.
    fn group(name: &str, seconds: &[f64]) -> Group {
        let goal = Goal { until: Until::Plateau, steps: 1 };
        Group {
            name: name.into(),
            run: RunDescription::new(preset("ar").unwrap(), None, &Device::Cpu, goal, None),
            ppo: PpoConfig::default(),
            users: seconds.iter().map(|&seconds| user(1.0, seconds, 0.2)).collect(),
        }
    }

    fn verdicts(comparison: &Comparison) -> Vec<Verdict> {
        comparison.differences.iter().map(|difference| difference.verdict).collect()
    }

    #[test]
    fn a_clear_difference_is_told_with_its_interval() {
        let (a, b) = (group("grid", &[0.65, 0.66, 0.64, 0.65]), group("row", &[0.77, 0.78, 0.76, 0.77]));
        let comparison = Comparison::new(&a, &b);
        assert_eq!(verdicts(&comparison), [Verdict::NoDifference, Verdict::Higher, Verdict::NoDifference]);
        let text = comparison.to_string();
        let sentence = "row is slower than grid: time per episode 0.77 s against 0.65 s (95 % interval of the difference: 0.11 s to 0.13 s)";
        assert!(text.lines().any(|line| line == sentence), "{text}");
        assert!(text.contains("no difference found in success: grid 100.0 %, row 100.0 %"), "{text}");
        assert_eq!(comparison.caveats, [] as [&str; 0]);
        // The other way round it is the other way round.
        assert_eq!(Comparison::new(&b, &a).differences[1].verdict, Verdict::Lower);
    }

    #[test]
    fn what_may_be_chance_or_training_is_not_claimed() {
        let (a, b) = (group("a", &[0.60, 0.70, 0.80]), group("b", &[0.65, 0.75, 0.85]));
        assert_eq!(Comparison::new(&a, &b).differences[1].verdict, Verdict::NoDifference);
        // Certain, but a fiftieth of the time: users may still become faster by a thirtieth.
        let (a, b) = (group("a", &[0.700, 0.701, 0.699]), group("b", &[0.714, 0.715, 0.713]));
        assert_eq!(Comparison::new(&a, &b).differences[1].verdict, Verdict::WithinTraining);
    }

    /// As fast with as much effort, and other muscles tire.
    #[test]
    fn the_more_tiring_layout_is_told() {
        let tiring = |name: &str, fatigue: [f64; 5]| {
            let mut group = group(name, &[0.65; 5]);
            for (user, fatigue) in group.users.iter_mut().zip(fatigue) {
                user.evaluation.fatigue = Some(fatigue);
            }
            group
        };
        let high = tiring("high", [0.0031, 0.0030, 0.0032, 0.0033, 0.0029]);
        let low = tiring("low", [0.0021, 0.0020, 0.0022, 0.0023, 0.0019]);
        let comparison = Comparison::new(&high, &low);
        assert_eq!(verdicts(&comparison)[2..], [Verdict::NoDifference, Verdict::Lower]);
        let sentence = "low is less tiring than high: fatigue per episode 0.210 % against 0.310 % ";
        assert!(comparison.sentences().any(|told| told.starts_with(sentence)), "{comparison}");
    }

    /// Users of the second layout fell into two habits: the spread of all hides from Welch's test that each is slower.
    #[test]
    fn a_difference_is_told_whatever_habits_users_fall_into() {
        let (a, b) =
            (group("a", &[0.630, 0.633, 0.635, 0.638, 0.640]), group("b", &[0.648, 0.650, 0.652, 0.724, 0.728]));
        assert_eq!(Comparison::new(&a, &b).differences[1].verdict, Verdict::Higher);
        let test = welch(&[0.630, 0.633, 0.635, 0.638, 0.640], &[0.648, 0.650, 0.652, 0.724, 0.728]).unwrap();
        assert!(test.p_value > 0.05 / 3.0, "{test:?}");
    }

    #[test]
    fn several_quantities_are_not_several_chances() {
        // One p-value between 0.05 / 3 and 0.05 is no claim among three.
        let (a, b) = (group("a", &[0.60, 0.62, 0.64, 0.66]), group("b", &[0.645, 0.675, 0.695, 0.725]));
        let comparison = Comparison::new(&a, &b);
        let p = comparison.differences[1].p_value.unwrap();
        assert!((0.05 / 3.0..0.05).contains(&p), "{p}");
        assert_eq!(comparison.differences[1].verdict, Verdict::NoDifference);
        assert_eq!(comparison.sentences().filter(|sentence| sentence.ends_with(CHANCE)).count(), 1, "{comparison}");
    }

    #[test]
    fn a_single_user_says_nothing_about_chance() {
        let comparison = Comparison::new(&group("a", &[0.6]), &group("b", &[0.7, 0.7]));
        assert_eq!(verdicts(&comparison), [Verdict::Unknown; 3]);
        assert!(comparison.to_string().contains("with a single user of a layout nobody can tell"), "{comparison}");
    }

    #[test]
    fn what_weakens_a_comparison_is_told() {
        let a = group("a", &[0.6, 0.6]);
        let told = |change: &dyn Fn(&mut Group)| {
            let mut b = group("b", &[0.6, 0.6]);
            change(&mut b);
            Comparison::new(&a, &b).caveats.join("; ")
        };
        type Case<'a> = (&'a dyn Fn(&mut Group), &'a str);
        let cases: [Case; 7] = [
            (&|b| b.run.task.model = "mobl-arms-uitb".into(), "bodies differ (myo-arm and mobl-arms-uitb)"),
            (&|b| b.run.version = "0.0.1".into(), "trained by different versions"),
            (&|b| b.run.task = preset("pointing-uitb").unwrap(), "the tasks ask for different things"),
            (&|b| b.run.task.script.truncate(2), "targets: whole tasks are compared"),
            (&|b| b.run.task.reward.distance_cost *= 2.0, "rewarded differently"),
            (&|b| b.ppo.num_envs = 1, "different goals or settings"),
            (&|b| b.users[1].trend = None, "1 of 2 users of b had not finished learning"),
        ];
        for (change, sentence) in cases {
            assert!(told(change).contains(sentence), "{sentence}: {}", told(change));
        }
        assert_eq!(told(&|_| ()), "");
    }

    /// A layout compared with itself: in how many of many comparisons is any difference claimed?
    #[test]
    fn a_layout_hardly_ever_differs_from_itself() {
        // Two of five users each from forty whose times spread by a tenth, drawn by a linear congruential generator.
        let mut state = 1_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let pool: Vec<f64> = (0..40).map(|_| 0.7 + 0.07 * ((0..12).map(|_| draw()).sum::<f64>() - 6.0)).collect();
        let mut claims = 0;
        for _ in 0..400 {
            let mut users = pool.clone();
            for k in 0..10 {
                users.swap(k, k + (draw() * (40 - k) as f64) as usize);
            }
            let comparison = Comparison::new(&group("a", &users[..5]), &group("b", &users[5..10]));
            claims += u32::from(verdicts(&comparison).iter().any(|v| matches!(v, Verdict::Higher | Verdict::Lower)));
        }
        assert!(claims <= 32, "{claims} of 400");
    }
}
