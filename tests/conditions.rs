//! Muscle conditions: weak muscles pull less, tired ones too, and results name the condition.

use msk::compiler::compile;
use msk::evaluate::Trial;
use msk::physics::{self, State, Workspace};
use msk::runtime::condition::{Fatigue, MuscleCondition, Weakness};
use msk::runtime::library::{BodyLibrary, BoundBody, FileLoader};
use std::path::Path;
use std::sync::OnceLock;

fn trial() -> &'static Trial {
    static TRIAL: OnceLock<Trial> = OnceLock::new();
    TRIAL.get_or_init(|| {
        let library = BodyLibrary::default();
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tasks.msk");
        let compilation = compile(Path::new(file), &FileLoader, &library).unwrap_or_else(|report| panic!("{report}"));
        let task = compilation.tasks.iter().find(|task| task.name == "stand").unwrap().clone();
        let body = library.bind(&task.body).unwrap();
        Trial::new(task, body)
    })
}

fn weak(muscles: Option<&str>, factor: f64) -> Weakness {
    Weakness { muscles: muscles.map(str::to_owned), factor }
}

fn condition(weakness: Vec<Weakness>) -> MuscleCondition {
    MuscleCondition { weakness, fatigue: None }
}

/// Active force at full activation and passive force of all muscles at the reference configuration.
fn forces(body: &BoundBody) -> [Vec<f64>; 2] {
    let mut workspace = Workspace::new(&body.model);
    physics::smooth(&body.model, &State::new(&body.model), &mut workspace);
    [workspace.actuation.gain.clone(), workspace.actuation.bias.clone()]
}

#[test]
fn weakness_scales_the_active_force_of_the_named_muscles_alone() {
    let healthy = &trial().body;
    let named = healthy.body.muscles[200].name.clone();
    let weakened = healthy.under(&condition(vec![weak(None, 0.5), weak(Some(&named), 0.4)])).unwrap();
    let ([before, passive], [after, still]) = (forces(healthy), forces(&weakened));
    for (muscle, (before, after)) in before.iter().zip(&after).enumerate() {
        let factor = if muscle == 200 { 0.2 } else { 0.5 };
        assert!((after - factor * before).abs() <= 1e-12 * before.abs(), "{}", healthy.body.muscles[muscle].name);
    }
    assert_eq!(passive, still);
    assert_eq!(healthy.body, weakened.body, "a task means what it meant");
}

#[test]
fn a_group_can_be_weak_and_a_condition_shows_in_the_hash() {
    let healthy = &trial().body;
    let group = healthy.body.groups.iter().find(|group| group.kind == msk::compiler::vocabulary::GroupKind::Muscles).unwrap();
    let strengths = condition(vec![weak(Some(&group.name), 0.25)]).strengths(&healthy.body).unwrap();
    for (muscle, strength) in strengths.into_iter().enumerate() {
        assert_eq!(strength, if group.members.contains(&muscle) { 0.25 } else { 1.0 });
    }
    let hash = |condition: &MuscleCondition| healthy.under(condition).unwrap().hash().to_owned();
    let tired = MuscleCondition { fatigue: Some(Fatigue::default()), ..MuscleCondition::default() };
    let hashes = [
        healthy.hash().to_owned(),
        hash(&tired),
        hash(&condition(vec![weak(None, 0.5)])),
        hash(&condition(vec![weak(Some(&group.name), 0.5)])),
    ];
    assert_eq!(hash(&MuscleCondition::default()), healthy.hash());
    assert_eq!(hashes.iter().collect::<std::collections::BTreeSet<_>>().len(), hashes.len());
}

#[test]
fn what_a_body_cannot_have_is_refused_in_words() {
    let refused = |condition: &MuscleCondition| trial().body.under(condition).unwrap_err().to_string();
    assert_eq!(
        refused(&condition(vec![weak(Some("solus_r"), 0.5)])),
        "the body `human` has no muscle or group of muscles `solus_r`; did you mean `soleus_r`?"
    );
    let text = refused(&condition(vec![weak(None, 1.5)]));
    assert_eq!(text, "the strength of a muscle condition is 1.5; it must be between 0 and 1");
    let fatigue = Some(Fatigue { recovery: f64::NAN, ..Fatigue::default() });
    assert!(refused(&MuscleCondition { weakness: vec![], fatigue }).contains("rate of recovery"));
}

#[test]
fn conditions_are_plain_data() {
    let text = r#"{"weakness":[{"muscles":"calves","factor":0.5}],"fatigue":{"fatigue":0.0182,"recovery":0.00168,"rest":15.0}}"#;
    let condition: MuscleCondition = serde_json::from_str(text).unwrap();
    assert_eq!(serde_json::to_string(&condition).unwrap(), text);
    assert_eq!(serde_json::to_string(&MuscleCondition::default()).unwrap(), "{}");
    assert!(serde_json::from_str::<MuscleCondition>(r#"{"weaknes":[]}"#).is_err());
}

/// Full effort tires so fast here that a tenth of a second shows; the excitation of a muscle is what it can still bring up.
#[test]
fn tired_muscles_get_what_they_can_bring_up_and_snapshots_keep_how_tired_they_are() {
    let rates = Fatigue { fatigue: 1.0, recovery: 0.01, rest: 10.0 };
    let condition = MuscleCondition { weakness: vec![], fatigue: Some(rates) };
    let Trial { task, body, .. } = trial().clone();
    let tired = Trial::new(task, body.under(&condition).unwrap());
    let mut episode = tired.episode().unwrap();
    let effort = vec![1.0; episode.context().body.muscles.len()];
    assert_eq!(episode.compartments().unwrap().of(7), [0.0, 1.0, 0.0]);
    for _ in 0..5 {
        episode.step(&effort).unwrap();
    }
    let snapshot = episode.snapshot();
    let mut other = tired.episode().unwrap();
    other.restore(&snapshot);
    for episode in [&mut episode, &mut other] {
        for _ in 0..5 {
            episode.step(&effort).unwrap();
        }
    }
    assert_eq!(episode.snapshot(), other.snapshot());
    let [active, _, fatigued] = episode.compartments().unwrap().of(7);
    assert!((0.03..0.2).contains(&fatigued) && active > 0.7, "{active} active, {fatigued} fatigued");
    assert_eq!(episode.state().control[7], 1.0 - fatigued);
    // A new episode begins fresh.
    episode.reset(episode.key());
    assert_eq!(episode.compartments().unwrap().of(7), [0.0, 1.0, 0.0]);
    assert!(trial().episode().unwrap().compartments().is_none());
}
