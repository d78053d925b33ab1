//! The targets of computed muscle control that an action moves: `act cmc { joints legs, range 0.5 rad, com 10 cm }`.

use super::spaces::form;
use super::{MOST_ANGLE, MOST_LENGTH, MOST_TIME, Settings};
use crate::action::{ActionTarget, Along, TrackingOffsets};
use crate::check::context::{Checked, Checker};
use crate::check::dimension::Dimension;
use crate::diagnostics::codes;
use crate::numbers::for_people;
use crate::syntax::tree::ExprKind;
use crate::vocabulary::{Group, GroupKind};

impl<'a> Checker<'a> {
    pub(super) fn tracking_offsets(&mut self, settings: &Settings<'a>) -> Checked<ActionTarget> {
        let reach = self.amount(settings, "reach", Dimension::LENGTH, MOST_LENGTH)?;
        let offsets = TrackingOffsets {
            joints: self.controlled_joints(settings)?,
            range: self.amount(settings, "range", Dimension::ANGLE, MOST_ANGLE)?,
            center_of_mass: self.amount(settings, "com", Dimension::LENGTH, MOST_LENGTH)?,
            root: self.amount(settings, "root", Dimension::ANGLE, MOST_ANGLE)?,
            hands: if reach > 0.0 { self.hands(settings)? } else { Vec::new() },
            reach,
            along: self.along(settings)?,
            ..TrackingOffsets::default()
        };
        let missing = match (offsets.joints.is_empty(), offsets.range > 0.0) {
            (true, true) => Some(("`range` is the offset of joints, and there are none", form("joints"))),
            (false, false) => Some(("`joints` needs `range`, the offset of their targets", "range 0.5 rad")),
            _ if offsets.size() == 0 => Some(("`act cmc` moves no target", "joints [legs, lumbar], range 0.5 rad, com 10 cm")),
            _ => None,
        };
        match missing {
            None => Ok(ActionTarget::MuscleControl(offsets)),
            Some((message, example)) => {
                let diagnostic = self
                    .diagnostic(codes::tasks::MISSING, settings.act.target.span, message)
                    .help(format!("write `{example}`; `com 10 cm` and `root 20 deg` move other targets"));
                Err(self.report(diagnostic))
            }
        }
    }

    /// What has the targets: a gait where there is a pace, what `along` names, or the reference.
    fn along(&mut self, settings: &Settings<'a>) -> Checked<Along> {
        let followed = self.followed(settings)?;
        let leads_on = matches!(followed, Along::Demonstration) && settings.get("pace").is_some();
        if let Some(start) = settings.get("start").filter(|_| !leads_on) {
            let message = "`start` is where a body that has walked goes on with the demonstration";
            let whole = ["pace", "along", "start"].map(form).join(", ");
            let diagnostic = self.diagnostic(codes::tasks::MISSING, start.span, message).help(format!("write `{whole}`"));
            return Err(self.report(diagnostic));
        }
        let Some(pace) = self.pace(settings)? else {
            if let Some(speed) = settings.get("speed") {
                let message = "`speed` needs `pace`, by how much entries change it";
                let diagnostic =
                    self.diagnostic(codes::tasks::MISSING, speed.span, message).help(format!("write `{}`", form("pace")));
                return Err(self.report(diagnostic));
            }
            return Ok(followed);
        };
        // It leads the feet to wherever the centre of mass falls; and follows no motion while it walks.
        let (needless, message, reason) = match (settings.get("com"), settings.get("along")) {
            (Some(com), _) => (com, "`com` does not go with `pace`", "the steps of a gait say where the centre of mass goes"),
            (None, Some(along)) if !leads_on => {
                (along, "`along reference` does not go with `pace`", "a gait follows no reference")
            }
            _ => {
                let then = leads_on.then(|| self.amount(settings, "start", Dimension::TIME, MOST_TIME)).transpose()?;
                return Ok(Along::Gait { speed: self.speed(settings, pace[0])?, pace, then });
            }
        };
        let diagnostic = self
            .diagnostic(codes::tasks::UNKNOWN_SETTING, needless.span, message)
            .help(format!("{reason}: leave out `{}` or `pace`", needless.name.text));
        Err(self.report(diagnostic))
    }

    /// `pace [1 m/s, 20 cm/s, 30 deg/s]`.
    fn pace(&mut self, settings: &Settings<'a>) -> Checked<Option<[f64; 3]>> {
        let Some(field) = settings.get("pace") else { return Ok(None) };
        let expr = self.setting_value(field)?;
        let elements = if let ExprKind::List(elements) = &expr.kind { elements.as_slice() } else { &[] };
        let [forward, left, turn] = elements else {
            let diagnostic = self
                .diagnostic(codes::types::LENGTHS_DIFFER, expr.span, "`pace` has three speeds")
                .expected("the largest forward, to the left and of the turn")
                .help(format!("write `{}`", form("pace")));
            return Err(self.report(diagnostic));
        };
        let [most_forward, most_left, most_turn] = Along::MOST_PACE;
        Ok(Some([
            self.bounded(forward, "pace", Dimension::SPEED, most_forward)?,
            self.bounded(left, "pace", Dimension::SPEED, most_left)?,
            self.bounded(turn, "pace", Dimension::ANGULAR_VELOCITY, most_turn)?,
        ]))
    }

    /// `speed 0.8 m/s`, for a pace that is changed by up to `range`.
    fn speed(&mut self, settings: &Settings<'a>, range: f64) -> Checked<f64> {
        let Some(field) = settings.get("speed") else { return Ok(0.0) };
        let expr = self.setting_value(field)?;
        let speed = self.fixed_number(expr, Dimension::SPEED, "`speed`")?;
        let fastest = speed.abs() + range;
        if fastest <= Along::MOST_PACE[0] {
            return Ok(speed);
        }
        let message = "a gait is asked to go faster than it can";
        let diagnostic = self
            .diagnostic(codes::tasks::OUT_OF_RANGE, field.span, message)
            .expected("`speed` and the first of `pace` come to 2 m/s at most")
            .found(format!("{} m/s", for_people(fastest)));
        Err(self.report(diagnostic))
    }

    /// `along demonstration`.
    fn followed(&mut self, settings: &Settings<'a>) -> Checked<Along> {
        let Some(field) = settings.get("along") else { return Ok(Along::Reference) };
        let expr = self.setting_value(field)?;
        match &expr.kind {
            ExprKind::Name(name) if name.text == "reference" => Ok(Along::Reference),
            ExprKind::Name(name) if name.text == "demonstration" => Ok(Along::Demonstration),
            _ => {
                let diagnostic = self
                    .diagnostic(codes::tasks::UNKNOWN_SETTING, expr.span, "computed muscle control cannot follow this")
                    .expected("`along reference` or `along demonstration`")
                    .help("`pace` lets it walk");
                Err(self.report(diagnostic))
            }
        }
    }

    /// The landmarks that reach.
    fn hands(&mut self, settings: &Settings<'a>) -> Checked<Vec<usize>> {
        let is_hands = |group: &&Group| group.kind == GroupKind::Landmarks && group.name == "hands";
        match self.vocabulary.groups.iter().find(is_hands) {
            Some(hands) => Ok(hands.members.clone()),
            None => {
                let span = settings.get("reach").map_or(settings.act.target.span, |field| field.span);
                let diagnostic = self
                    .diagnostic(codes::tasks::MISSING, span, "this body has no hands that could reach")
                    .expected("a group `hands` of landmarks in its description");
                Err(self.report(diagnostic))
            }
        }
    }
}
