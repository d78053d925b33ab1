//! The `compiler` and `option` elements. Both may be repeated: the last value of each attribute stands.

use super::length_range::LengthRanges;
use crate::model::mjcf::document::Element;
use crate::model::mjcf::error::ModelError;
use crate::model::{Cone, Integrator, Options, Quaternion, SolverParameters, Switches, rotation};
use nalgebra::Vector3;

/// When a body's inertia comes from its geoms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::model::mjcf) enum InertiaFromGeoms {
    Never,
    Always,
    WhereMissing,
}

/// How the file is to be read.
#[derive(Debug)]
pub(in crate::model::mjcf) struct Settings {
    pub degrees: bool,
    pub infer_limits: bool,
    pub euler_sequence: [u8; 3],
    pub mesh_folder: Option<String>,
    pub strip_paths: bool,
    pub inertia_from_geoms: InertiaFromGeoms,
    pub inertia_groups: [i64; 2],
    pub least_mass: f64,
    pub least_inertia: f64,
    pub balance_inertia: bool,
    /// The mass that all bodies together are scaled to, kg.
    pub total_mass: Option<f64>,
    /// Whether free bodies without children are aligned with their principal axes of inertia.
    pub align_free: bool,
    /// How missing length ranges are found.
    pub length_ranges: LengthRanges,
}

/// Reads all `compiler` elements.
pub(super) fn compiler_settings(root: &Element) -> Result<Settings, ModelError> {
    let mut settings = Settings {
        degrees: true,
        infer_limits: true,
        euler_sequence: *b"xyz",
        mesh_folder: None,
        strip_paths: false,
        inertia_from_geoms: InertiaFromGeoms::WhereMissing,
        inertia_groups: [0, 5],
        least_mass: 0.0,
        least_inertia: 0.0,
        balance_inertia: false,
        total_mass: None,
        align_free: false,
        length_ranges: LengthRanges::default(),
    };
    for element in root.children.iter().filter(|child| child.tag == "compiler") {
        settings.update(element)?;
    }
    Ok(settings)
}

impl Settings {
    fn update(&mut self, element: &Element) -> Result<(), ModelError> {
        if let Some(unit) = element.keyword("angle", &["radian", "degree"])? {
            self.degrees = unit == 1;
        }
        if let Some(sequence) = element.text("eulerseq") {
            let letters: Option<[u8; 3]> = sequence.as_bytes().try_into().ok();
            let letters = letters.filter(|letters| rotation::from_euler([0.0; 3], letters).is_some());
            self.euler_sequence =
                letters.ok_or_else(|| element.invalid("`eulerseq` expects three letters out of x, y, z, X, Y, Z"))?;
        }
        let folder = element.text("meshdir").or(element.text("assetdir"));
        self.mesh_folder = folder.map(str::to_owned).or(self.mesh_folder.take());
        self.inertia_from_geoms = match element.keyword("inertiafromgeom", &["false", "true", "auto"])? {
            Some(0) => InertiaFromGeoms::Never,
            Some(1) => InertiaFromGeoms::Always,
            Some(_) => InertiaFromGeoms::WhereMissing,
            None => self.inertia_from_geoms,
        };
        if let Some([first, last]) = element.numbers::<2>("inertiagrouprange")? {
            self.inertia_groups = [first as i64, last as i64];
        }
        self.infer_limits = element.flag("autolimits")?.unwrap_or(self.infer_limits);
        self.strip_paths = element.flag("strippath")?.unwrap_or(self.strip_paths);
        self.balance_inertia = element.flag("balanceinertia")?.unwrap_or(self.balance_inertia);
        self.least_mass = element.size_or("boundmass", self.least_mass)?;
        self.least_inertia = element.size_or("boundinertia", self.least_inertia)?;
        for child in element.children.iter().filter(|child| child.tag == "lengthrange") {
            self.length_ranges.update(child)?;
        }
        self.align_free = element.flag("alignfree")?.unwrap_or(self.align_free);
        if let Some([mass]) = element.numbers::<1>("settotalmass")? {
            self.total_mass = (mass > 0.0).then_some(mass);
        }
        Ok(())
    }

    /// An angle of the file in radians.
    pub fn radians(&self, angle: f64) -> f64 {
        if self.degrees { angle.to_radians() } else { angle }
    }

    /// The orientation that an element gives in one of the five forms.
    pub fn orientation(&self, element: &Element) -> Result<Quaternion, ModelError> {
        let vector = |x: f64, y: f64, z: f64| Vector3::new(x, y, z);
        let mut forms = Vec::new();
        if let Some(q) = element.numbers::<4>("quat")? {
            forms.push(rotation::normalized(q));
        }
        if let Some([x, y, z, angle]) = element.numbers::<4>("axisangle")? {
            let axis = rotation::unit_vector(vector(x, y, z));
            forms.push(axis.map(|axis| rotation::about(axis, self.radians(angle))).and_then(rotation::normalized));
        }
        if let Some([x, y, z, u, v, w]) = element.numbers::<6>("xyaxes")? {
            forms.push(rotation::from_xy_axes(vector(x, y, z), vector(u, v, w)));
        }
        if let Some([x, y, z]) = element.numbers::<3>("zaxis")? {
            forms.push(rotation::from_z_axis(vector(x, y, z)));
        }
        if let Some(angles) = element.numbers::<3>("euler")? {
            forms.push(rotation::from_euler(angles.map(|angle| self.radians(angle)), &self.euler_sequence));
        }
        match forms[..] {
            [] => Ok(rotation::IDENTITY),
            [Some(q)] => Ok(q),
            [None] => Err(element.invalid("the orientation is degenerate: a zero quaternion or axis, or parallel axes")),
            _ => Err(element.invalid("the orientation is given more than once")),
        }
    }

    /// Whether a limit applies: set, or inferred from a range being there.
    pub fn limited(&self, element: &Element, flag: &str, range: &str) -> Result<Option<[f64; 2]>, ModelError> {
        let bounds = element.numbers::<2>(range)?;
        let limited = match element.keyword(flag, &["false", "true", "auto"])? {
            Some(0) => false,
            Some(1) => true,
            _ if self.infer_limits => bounds.is_some_and(|[low, high]| low != 0.0 || high != 0.0),
            _ if bounds.is_some() => {
                return Err(element.invalid(format!("`{range}` without `{flag}`, and `autolimits` is off")));
            }
            _ => false,
        };
        if !limited {
            return Ok(None);
        }
        match bounds {
            Some([low, high]) if low < high => Ok(bounds),
            Some([low, high]) => Err(element.invalid(format!("`{range}` is empty: {low} is not below {high}"))),
            None => Err(element.invalid(format!("`{flag}` is true, but there is no `{range}`"))),
        }
    }
}

/// Reads all `option` elements.
pub(super) fn options(root: &Element) -> Result<Options, ModelError> {
    let mut options = Options::default();
    let mut weightless = false;
    for element in root.children.iter().filter(|child| child.tag == "option") {
        options.timestep = element.number_or("timestep", options.timestep)?;
        if options.timestep <= 0.0 {
            return Err(element.invalid("`timestep` must be positive"));
        }
        const INTEGRATORS: [(&str, Integrator); 3] =
            [("Euler", Integrator::Euler), ("implicitfast", Integrator::Implicit), ("RK4", Integrator::RungeKutta)];
        if let Some(index) = element.keyword("integrator", &INTEGRATORS.map(|(word, _)| word))? {
            options.integrator = INTEGRATORS[index].1;
        }
        for flag in element.children.iter().filter(|child| child.tag == "flag") {
            options.euler_damping =
                flag.keyword("eulerdamp", &["disable", "enable"])?.map_or(options.euler_damping, |word| word == 1);
        }
        options.gravity = element.vector_or("gravity", options.gravity)?;
        options.fluid.density = element.size_or("density", options.fluid.density)?;
        options.fluid.viscosity = element.size_or("viscosity", options.fluid.viscosity)?;
        options.fluid.wind = element.vector_or("wind", options.fluid.wind)?;
        options.iterations = count(element, "iterations", options.iterations)?;
        options.line_search_iterations = count(element, "ls_iterations", options.line_search_iterations)?;
        options.tolerance = element.size_or("tolerance", options.tolerance)?;
        options.line_search_tolerance = element.size_or("ls_tolerance", options.line_search_tolerance)?;
        options.no_slip_iterations = count(element, "noslip_iterations", options.no_slip_iterations)?;
        options.no_slip_tolerance = element.size_or("noslip_tolerance", options.no_slip_tolerance)?;
        options.impedance_ratio = element.number_or("impratio", options.impedance_ratio)?;
        if options.impedance_ratio <= 0.0 {
            return Err(element.invalid("`impratio` must be positive"));
        }
        options.cone = match element.keyword("cone", &["pyramidal", "elliptic"])? {
            Some(0) => Cone::Pyramidal,
            Some(_) => Cone::Elliptic,
            None => options.cone,
        };
        // All of MuJoCo's solvers approach the same optimum; Newton's method finds it whichever is asked for.
        element.keyword("solver", &["PGS", "CG", "Newton"])?;
        for flags in element.children.iter().filter(|child| child.tag == "flag") {
            read_switches(flags, &mut options.switches)?;
            weightless = flags.keyword("gravity", &["disable", "enable"])?.map_or(weightless, |word| word == 0);
        }
    }
    if weightless {
        options.gravity = Vector3::zeros();
    }
    Ok(options)
}

/// Kinds of constraints that a `flag` element switches; `constraint` is the main switch of all of them.
fn read_switches(flags: &Element, switches: &mut Switches) -> Result<(), ModelError> {
    let off = |name: &str| Ok::<_, ModelError>(flags.keyword(name, &["disable", "enable"])? == Some(0));
    let all_off = off("constraint")?;
    for (name, switch) in [
        ("equality", &mut switches.equality),
        ("frictionloss", &mut switches.friction_loss),
        ("limit", &mut switches.limit),
        ("contact", &mut switches.contact),
    ] {
        *switch &= !(off(name)? || all_off);
    }
    switches.safe_reference &= !off("refsafe")?;
    Ok(())
}

fn count(element: &Element, attribute: &str, otherwise: usize) -> Result<usize, ModelError> {
    const MOST: i64 = 1_000_000;
    let number = element.integer_or(attribute, otherwise as i64, 0, MOST)?;
    Ok(usize::try_from(number).unwrap_or(otherwise))
}

/// SolverParameters from a pair of attributes.
pub(super) fn softness(element: &Element, reference: &str, impedance: &str) -> Result<SolverParameters, ModelError> {
    let standard = SolverParameters::default();
    Ok(SolverParameters {
        reference: element.numbers_over(reference, standard.reference)?,
        impedance: element.numbers_over(impedance, standard.impedance)?,
    })
}
