//! Contact pairs and exclusions.

use super::names::Kind;
use super::settings::softness;
use super::shapes::contact_dimension;
use super::{Compiler, section};
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;

impl Compiler<'_> {
    /// Reads the `contact` sections. Like MuJoCo, pairs and exclusions are kept in the order of the bodies they concern.
    pub(super) fn read_contacts(&mut self) -> Result<(), ModelError> {
        let document = self.document;
        let mut pairs = Vec::new();
        for element in section(&document.root, "contact") {
            if element.tag == "pair" {
                let first = self.names.required(Kind::Geom, element, "geom1")?;
                let second = self.names.required(Kind::Geom, element, "geom2")?;
                let body = |geom: usize| self.model.geoms.body[geom];
                let geoms = if body(first) > body(second) { [second, first] } else { [first, second] };
                pairs.push((geoms.map(body), geoms, self.defaults.resolve(element, None)?));
            } else {
                let first = self.names.required(Kind::Body, element, "body1")?;
                let second = self.names.required(Kind::Body, element, "body2")?;
                self.model.exclusions.push((first.min(second), first.max(second)));
            }
        }
        self.model.exclusions.sort_unstable();
        pairs.sort_by_key(|(bodies, ..)| *bodies);
        pairs.iter().try_for_each(|(_, geoms, element)| self.add_pair(*geoms, element))
    }

    fn add_pair(&mut self, geoms: [usize; 2], element: &Element) -> Result<(), ModelError> {
        let pairs = &mut self.model.pairs;
        pairs.geoms.push(geoms);
        pairs.dimension.push(contact_dimension(element)?);
        pairs.softness.push(softness(element, "solref", "solimp")?);
        pairs.friction_reference.push(element.numbers_over("solreffriction", [0.0; 2])?);
        pairs.friction.push(element.numbers_over("friction", [1.0, 1.0, 0.005, 0.0001, 0.0001])?);
        pairs.margin.push(element.number_or("margin", 0.0)?);
        pairs.gap.push(element.number_or("gap", 0.0)?);
        Ok(())
    }
}
