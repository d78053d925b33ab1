//! Scenes as data: what a text becomes for the runtime, number by number.

#[allow(dead_code)] // Pages serve the other tests.
use crate::support;

use msk_compiler::Draws;
use msk_compiler::frame::{Origin, Query, Sensor};
use msk_compiler::scene::{Motion, ObjectJointKind, Parent, Part, Shape, Terrain};
use msk_compiler::task::{CompiledTask, Spread};
use std::sync::Arc;
use support::compiling::{compile_text, complete, vocabulary};

fn task(statements: &str) -> Arc<CompiledTask> {
    // Constants stand before the task.
    let (constants, statements): (Vec<&str>, Vec<&str>) =
        statements.lines().partition(|line| line.trim_start().starts_with("const "));
    let text = format!("{}\n{}", constants.join("\n"), complete(&statements.join("\n")));
    let compilation = compile_text(&text, &[]).unwrap_or_else(|report| panic!("{report}"));
    compilation.tasks[0].clone()
}

fn close<const N: usize>(found: [f64; N], wanted: [f64; N]) {
    assert!(found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}, not {wanted:?}");
}

const DOOR: &str = "scene {
    ground { friction 1.5 }
    body door {
        at [0.8 m, -0.55 m, 5 cm]
        orientation 90 deg
        hinge swing { axis [0, 0, -2], at [1 cm, 0, 0], range 0 deg .. 90 deg, damping 0.05 N*m*s/rad, friction 0.2 N*m }
        box leaf { size [0.08 m, 1.10 m, 2.2 m], at [0, 0.55 m, 1.1 m], density 100 kg/m^3, friction [0.5, 5 mm, 0.1 mm] }
        cylinder handle { from [-5 cm, 0.95 m, 0.85 m] to [-5 cm, 0.95 m, 1.15 m], radius 3 cm }
    }
    sphere ball { radius 11 cm, mass 0.4 kg, free, at [3 m, 0, 1.2 m] }
    group things = [ball, door.leaf]
}
observe { door.swing.q; touching(robot, things); door.leaf.size.left }";

/// A bar of three shapes weighs what they weigh together; what a joint carries moves by itself.
#[test]
fn an_object_weighs_what_it_carries() {
    let scene = task(
        "scene {
            ground
            body bar {
                at [0, 0, 2 m], free
                cylinder shaft  { along [0, 1, 0], length 1.3 m, radius 3 cm, mass 1 kg }
                cylinder plate_l { along [0, 1, 0], at [0, 0.7 m, 0], length 0.2 m, radius 0.2 m, mass 2 kg }
                cylinder plate_r { along [0, 1, 0], at [0, -0.7 m, 0], length 0.2 m, radius 0.2 m, mass 2 kg }
            }
            body door {
                at [3 m, 0, 0]
                hinge swing { axis [0, 0, 1] }
                box leaf { size [0.1 m, 1 m, 2 m], at [0, 0.5 m, 1.1 m], mass 19 kg }
                body flap { hinge turn { axis [0, 1, 0] }, box board { size [0.1 m, 0.1 m, 0.1 m], at [0, 0.5 m, 0.5 m], mass 3 kg } }
            }
        }
        observe { bar.height; door.swing.q; door.flap.turn.q }",
    )
    .scene
    .clone();
    let found = |name: &str| {
        let whole = vocabulary().with_scene(&scene);
        whole.landmarks.iter().find(|landmark| landmark.name == name).unwrap().mass
    };
    let names = ["bar", "bar.shaft", "bar.plate_l", "door", "door.leaf", "door.flap"];
    assert_eq!(names.map(found), [5.0, 1.0, 2.0, 19.0, 19.0, 3.0]);
}

#[test]
fn elements_become_objects_in_the_order_of_the_text_parents_first() {
    let task = task(DOOR);
    let names: Vec<&str> = task.scene.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["door", "door.leaf", "door.handle", "ball"]);
    let [door, leaf, handle, ball] = task.scene.objects.as_slice() else { panic!("{names:?}") };
    assert_eq!(task.scene.ground.unwrap().friction, [1.5, 0.005, 0.0001]);
    assert_eq!((&door.parent, &door.shape, door.mass), (&Parent::World, &None, 0.0));
    close(door.position, [0.8, -0.55, 0.05]);
    close(door.orientation, [0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt()]);
    let Motion::Joints(joints) = &door.motion else { panic!("{:?}", door.motion) };
    assert_eq!((joints[0].name.as_str(), joints[0].kind), ("door.swing", ObjectJointKind::Hinge));
    close(joints[0].axis, [0.0, 0.0, -1.0]);
    close(joints[0].anchor, [0.01, 0.0, 0.0]);
    close(joints[0].range.unwrap(), [0.0, std::f64::consts::FRAC_PI_2]);
    assert_eq!((joints[0].damping, joints[0].friction_loss, joints[0].stiffness), (0.05, 0.2, 0.0));
    assert_eq!((&leaf.parent, &leaf.motion), (&Parent::Object(0), &Motion::Fixed));
    assert_eq!(leaf.shape, Some(Shape::Box([0.08, 1.1, 2.2])));
    assert!((leaf.mass - 19.36).abs() < 1e-9, "{}", leaf.mass);
    assert_eq!(leaf.surface.friction, [0.5, 0.005, 0.0001]);
    close(handle.position, [-0.05, 0.95, 1.0]);
    let Some(Shape::Cylinder(radius, length)) = handle.shape else { panic!("{:?}", handle.shape) };
    close([radius, length], [0.03, 0.3]);
    assert_eq!((&ball.motion, &ball.shape), (&Motion::Free, &Some(Shape::Sphere(0.11))));
    assert_eq!(task.scene.groups, [("things".to_owned(), vec![3, 1])]);
}

#[test]
fn objects_join_the_vocabulary_behind_the_body() {
    let (task, body) = (task(DOOR), vocabulary());
    let whole = body.with_scene(&task.scene);
    let (landmarks, joints) = (body.landmarks.len(), body.joints.len());
    assert_eq!(whole.landmarks[landmarks].name, "door");
    // The leaf's middle, a quarter turn to the left of the door's own x.
    close(whole.landmarks[landmarks + 1].neutral_position, [0.8 - 0.55, -0.55, 1.15]);
    let sensors: Vec<Sensor> = task.frame.entries().iter().map(|(sensor, _)| *sensor).collect();
    let things = Part::Group(body.groups.len());
    assert!(sensors.contains(&Sensor::JointPosition(joints)), "{sensors:?}");
    assert!(sensors.contains(&Sensor::Touching(things, Part::Robot)), "{sensors:?}");
    assert_eq!(task.init.coordinates.len(), joints + 1);
    assert_eq!((task.init.objects.len(), task.init.objects[0].object), (1, 3));
    close(task.init.objects[0].position, [3.0, 0.0, 1.2]);
}

#[test]
fn what_stands_still_is_read_without_a_sensor() {
    let task = task(
        "scene {
            ground
            box seat { size [0.4 m, 0.4 m, 4 cm], at [-1 m, 0, 0.45 m] }
            box ramp { size [2 m, 1 m, 2 m], orientation [0, 45 deg, 0] }
        }
        observe { seat.position; seat.top; seat.velocity; ramp.top; seat.up; distance(seat, ramp) }
        reward { 1 a = step / 10 }
        success survived",
    );
    assert_eq!(task.frame.size(), 0, "{:?}", task.frame);
    let mut state = msk_compiler::task::TaskState::default();
    task.reset(&[], &mut msk_compiler::Middle, &mut state).unwrap();
    let mut seen = vec![0.0; task.observation_size()];
    task.observe(&[], &state, &mut seen);
    let wanted = [-1.0, 0.0, 0.45, 0.47, 0.0, 0.0, 0.0, 2_f64.sqrt(), 0.0, 0.0, 1.0, (1.0_f64 + 0.45 * 0.45).sqrt()];
    assert!(seen.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-12), "{seen:?}");
}

#[test]
fn terrain_is_sampled_and_asked() {
    let task = task(
        "scene {
            heights waves { size [2 m, 1 m], samples [3, 2], height 0.1 m * (x / 1 m) + 0.2 * y }
            stairs flight { count 4, rise 15 cm, run 50 cm, width 1 m, at [2 m, 0, 0], walkable false }
            repeat i in 0..2 { cylinder pole_{i} { radius 10 cm, length 2 m, at [1 m * (i + 1), 0, 1 m] } }
            group poles = pole_{*}
        }
        observe {
            ground_height(sole_l)
            scan(heading(pelvis), [[0.3 m, -0.2 m], [0.6 m, 0 m]])
            radar(torso, poles, sectors = 7, over = 180 deg, range = 2.5 m)
            ray(head, [0, 0, -2], range = 3 m)
            ground_normal([1 m, 0 m])
        }",
    );
    let Some(Shape::Terrain(Terrain::Heights { size, samples, heights })) = &task.scene.objects[0].shape else { panic!() };
    assert_eq!((*size, *samples), ([2.0, 1.0], [3, 2]));
    close::<6>(heights.clone().try_into().unwrap(), [-0.1, 0.0, 0.1, 0.1, 0.2, 0.3]);
    let walkable: Vec<bool> = task.scene.objects.iter().map(|object| object.surface.walkable).collect();
    assert_eq!(walkable, [true, false, false, false]);
    let body = vocabulary();
    let find = |name: &str| body.landmarks.iter().position(|landmark| landmark.name == name).unwrap();
    let pelvis = find("pelvis");
    let expected = [
        Query::GroundHeight(Origin::Landmark(find("sole_l"), [0.0; 3])),
        Query::GroundHeight(Origin::Landmark(pelvis, [0.3, -0.2, 0.0])),
        Query::GroundHeight(Origin::Landmark(pelvis, [0.6, 0.0, 0.0])),
        Query::Radar { from: find("torso"), group: body.groups.len(), sectors: 7, over: std::f64::consts::PI, range: 2.5 },
        Query::Ray { from: find("head"), direction: [0.0, 0.0, -1.0], range: 3.0 },
        Query::GroundNormal(Origin::World([1.0, 0.0, 0.0])),
    ];
    assert_eq!(task.frame.queries(), expected);
    assert_eq!(task.observation_size(), 1 + 2 + 7 + 1 + 3);
}

#[test]
fn initial_states_know_objects_noise_and_disturbances() {
    let task = task(
        "scene {
            ground
            body bar { at [0.4 m, 0, 2 m]; capsule shaft { along [0, 1, 0], length 1 m, radius 2 cm }; point grip { at [0, 0.2 m, 0] } }
            box cube { size [5 cm, 5 cm, 5 cm], mass 0.1 kg, free, at [1 m, 0, 1 m] }
            weld palm_l to bar.grip here release when step > 10
            marker goal at cube.position + [0, 0, 1 m]
        }
        init {
            pose neutral
            root { align palm_l to bar.grip }
            cube { velocity [-1.5 m/s, 0, 2.5 m/s], spin [0, 1 rad/s, 0], at [2 m, 0, 1 m] }
            noise hip_flexion_{l,r} uniform(-5 deg .. 5 deg)
            noise velocities normal(0, 0.1 rad/s)
            settle 50 ms with activation 0.2 at rest
        }
        disturb pelvis { force [50 N, 0, 0], at 3 s, for 0.1 s }",
    );
    let body = vocabulary();
    let (landmarks, hip) = (body.landmarks.len(), body.joints.iter().position(|joint| joint.name == "hip_flexion_r").unwrap());
    let palm = body.landmarks.iter().position(|landmark| landmark.name == "palm_l").unwrap();
    assert_eq!(task.init.root.meets, [(palm, Origin::World([0.4, 0.2, 2.0]))]);
    let start = task.init.objects[0];
    close(start.position, [2.0, 0.0, 1.0]);
    close(start.velocity, [-1.5, 0.0, 2.5]);
    close(start.spin, [0.0, 1.0, 0.0]);
    let five = 5.0_f64.to_radians();
    let Spread::Uniform(low, high) = task.init.coordinate_noise[hip] else { panic!() };
    close([low, high], [-five, five]);
    assert_eq!(task.init.coordinate_noise.iter().filter(|spread| **spread != Spread::None).count(), 2);
    assert!(task.init.velocity_noise.contains(&Spread::Normal(0.1)));
    let settle = task.init.settle.unwrap();
    assert_eq!((settle.steps, settle.activation, settle.at_rest), (50, 0.2, true));
    let push = task.disturbances[0];
    assert_eq!((push.start, push.steps, push.force), (300, 10, [50.0, 0.0, 0.0]));
    assert_eq!((task.releases.as_slice(), task.markers.as_slice()), ([0].as_slice(), ["goal".to_owned()].as_slice()));
    let held = &task.scene.connections[0];
    assert_eq!((held.from.as_str(), held.to.as_str(), held.weld, held.here), ("palm_l", "bar.grip", true, true));
    assert!(task.frame.entries().iter().any(|(sensor, _)| *sensor == Sensor::LandmarkPosition(landmarks + 3)));
}

#[test]
fn a_task_without_a_scene_stands_on_the_ground_and_a_scene_changes_its_hash() {
    let (bare, seated) = (task(""), task("scene { ground\n box seat { size [1 m, 1 m, 1 m], at [-2 m, 0, 0.5 m] } }"));
    assert!(bare.scene.ground.unwrap().walkable && bare.scene.objects.is_empty());
    assert_ne!(bare.hash, seated.hash);
    let moved = task("scene { ground\n box seat { size [1 m, 1 m, 1 m], at [-3 m, 0, 0.5 m] } }");
    assert_ne!(moved.hash, seated.hash);
    let renamed = task("scene {\n ground; box seat { at [-2 m, 0, 50 cm], size [100 cm, 1 m, 1 m] } }");
    assert_eq!(renamed.hash, seated.hash);
}

/// Always the same share of a range.
struct Share(f64);

impl Draws for Share {
    fn uniform(&mut self, _: usize) -> f64 {
        self.0
    }

    fn normal(&mut self, _: usize) -> f64 {
        0.0
    }
}

#[test]
fn a_random_places_an_object_anew_in_every_episode() {
    let task = task(
        "random lateral = uniform(-0.5 m .. 0.5 m)
        random bearing = uniform(0 deg .. 90 deg)
        scene { ground
            sphere ball { radius 11 cm, mass 0.4 kg, free, at [3 m, lateral, 1.2 m] }
        }
        init {
            pose neutral
            root { heading bearing / 2 }
            ball { velocity [-4 m/s, -lateral / 1 s, 1 m/s] }
        }
        observe { ball.position; lateral; bearing }",
    );
    for (share, lateral) in [(0.5, 0.0), (0.75, 0.25), (0.0, -0.5)] {
        let mut state = msk_compiler::task::TaskState::default();
        task.begin(&mut Share(share), &mut state).unwrap();
        let init = task.initial_state(&state);
        close(init.objects[0].position, [3.0, lateral, 1.2]);
        close(init.objects[0].velocity, [-4.0, -lateral, 1.0]);
        close([init.root.heading], [share * std::f64::consts::FRAC_PI_4]);
    }
    let snapshot = task.snapshot();
    let drawn = snapshot.sections.iter().find(|section| section.kind == "drawn" && section.name == "ball.position.y");
    assert!(drawn.is_some_and(|section| !section.graph.is_empty()), "{snapshot}");
}

#[test]
fn parameters_size_the_scene() {
    let task = task(
        "params { rise: length = 15 cm (10 cm..20 cm) }
        const treads = 4
        scene { ground; stairs flight { count treads, rise rise, run 2 * rise, width 1 m, at [1 m, 0, 0] } }
        terminate { high when pelvis.height > flight.top + 2 m }",
    );
    let Some(Shape::Terrain(Terrain::Stairs { count, rise, run, .. })) = task.scene.objects[0].shape else { panic!() };
    assert_eq!((count, rise, run), (4, 0.15, 0.3));
}

/// The second task, which extends the first, and the third, which declares the same by itself.
fn extended_and_written(first: &str, second: &str, third: &str) -> [Arc<CompiledTask>; 2] {
    let whole = |name: &str, statements: &str| complete(statements).replacen("task example", &format!("task {name}"), 1);
    let text = format!("{}\ntask second extends first {{ {second} }}\n{}", whole("first", first), whole("third", third));
    let compilation = compile_text(&text, &[]).unwrap_or_else(|report| panic!("{report}\n{text}"));
    let [_, second, third] = compilation.tasks.as_slice() else { panic!("{} tasks", compilation.tasks.len()) };
    [second.clone(), third.clone()]
}

#[test]
fn single_elements_of_an_extended_scene_are_replaced_where_they_stand_removed_and_added() {
    let [second, third] = extended_and_written(
        "scene {
            ground
            repeat i in 0..3 { sphere stone_{i} { radius 5 cm, at [1 m * i, 0, 5 cm] } }
            body rack { at [0, 0, 2 m]; box bar { size [1 m, 4 cm, 4 cm] }; point grip { at [0, 0, 0] } }
            weld palm_l to rack.grip here
            weld palm_r to rack.grip here
            group stones = stone_{*}
            marker goal at [5 m, 0, 1 m]
        }
        terminate { hit when touching(robot, stones) }",
        "scene {
            ground { friction 2 }
            sphere stone_1 { radius 20 cm, at [1 m, 1 m, 20 cm] }
            remove stone_2
            body rack { at [0, 0, 3 m]; point grip { at [0, 0, 1 cm] } }
            weld palm_l to rack.grip
            remove palm_r
            box wall { size [1 m, 1 m, 1 m], at [9 m, 0, 0.5 m] }
            group stones = [stone_{*}, wall]
            marker goal at [6 m, 0, 1 m]
        }",
        "scene {
            ground { friction 2 }
            sphere stone_0 { radius 5 cm, at [0 m, 0, 5 cm] }
            sphere stone_1 { radius 20 cm, at [1 m, 1 m, 20 cm] }
            body rack { at [0, 0, 3 m]; point grip { at [0, 0, 1 cm] } }
            box wall { size [1 m, 1 m, 1 m], at [9 m, 0, 0.5 m] }
            weld palm_l to rack.grip
            group stones = [stone_{*}, wall]
            marker goal at [6 m, 0, 1 m]
        }
        terminate { hit when touching(robot, stones) }",
    );
    assert_eq!(second.scene, third.scene);
    assert_eq!(second.snapshot().to_string().replace("second", "third"), third.snapshot().to_string());
}

#[test]
fn single_parts_of_an_extended_initial_state_are_replaced_removed_and_added() {
    let [second, third] = extended_and_written(
        "scene { ground; sphere ball { radius 11 cm, mass 0.4 kg, free, at [3 m, 0, 1.2 m] } }
        init {
            pose squatting
            root { height on ground, velocity [1 m/s, 0, 0] }
            ball { velocity [-4 m/s, 0, 1 m/s], spin [0, 2 rad/s, 0] }
            noise joints normal(0, 0.005 rad)
            noise velocities normal(0, 0.01 rad/s)
            settle 50 ms
        }",
        "init {
            pose neutral
            ball { velocity [-6 m/s, 0, 0] }
            noise joints normal(0, 0.02 rad)
            remove velocities
            remove settle
        }",
        "scene { ground; sphere ball { radius 11 cm, mass 0.4 kg, free, at [3 m, 0, 1.2 m] } }
        init {
            pose neutral
            root { height on ground, velocity [1 m/s, 0, 0] }
            ball { velocity [-6 m/s, 0, 0] }
            noise joints normal(0, 0.02 rad)
        }",
    );
    assert_eq!(second.init, third.init);
    assert_eq!(second.snapshot().to_string().replace("second", "third"), third.snapshot().to_string());
}
