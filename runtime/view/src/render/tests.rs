use super::camera::Camera;
use super::palette::{DARK, LIGHT, heat};
use super::*;
use crate::tests::crouching;
use msk_physics::State;
use std::path::Path;

const SMALL: Options = Options { width: 160, height: 200, view: View::ThreeQuarter, theme: Theme::Light, labels: true };

/// Scenes of a body that crouches, its muscles more and more active.
fn scenes(frames: u32, colouring: Colouring) -> Vec<Scene> {
    let (mut renderer, mut scenes) = (None, Vec::new());
    crouching(frames, |frame, snapshot| {
        let renderer = renderer.get_or_insert_with(|| Renderer::of(snapshot, &[], colouring));
        scenes.push(renderer.scene_of(0.1 * f64::from(frame), snapshot, None));
    });
    scenes
}

/// Mean difference of the bytes of two pictures of one size.
fn difference(first: &Picture, second: &[u8]) -> f64 {
    assert_eq!(first.bytes().len(), second.len());
    let apart = |(a, b): (&u8, &u8)| f64::from(a.abs_diff(*b));
    first.bytes().iter().zip(second).map(apart).sum::<f64>() / second.len() as f64
}

fn read(path: &Path) -> Vec<u8> {
    let mut reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut bytes).unwrap();
    bytes
}

/// `MSK_UPDATE=1` writes the reference anew; look at it before it is committed.
#[test]
fn a_crouch_looks_as_it_did() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render/crouch.png");
    let scene = scenes(3, Colouring::Activation).pop().unwrap();
    let pictures = [(); 2].map(|()| scene.render(&SMALL).unwrap());
    assert_eq!(pictures[0].png().unwrap(), pictures[1].png().unwrap());
    if std::env::var_os("MSK_UPDATE").is_some_and(|value| !value.is_empty()) {
        std::fs::write(&path, pictures[0].png().unwrap()).unwrap();
    }
    let apart = difference(&pictures[0], &read(&path));
    assert!(apart == 0.0, "mean difference {apart} of 255 from `{}`", path.display());
}

#[test]
fn colours_and_views_are_those_of_the_page() {
    let (palette, camera) = (include_str!("../page/palette.js"), include_str!("../page/camera.js"));
    for colours in [LIGHT, DARK] {
        let palette::Colours { sky, ground, line, skin, scenery, bone, ghost, arrow, marker, tendon, .. } = colours;
        let named = [("sky", sky), ("ground", ground), ("line", line), ("skin", skin), ("scenery", scenery)];
        let more = [("bone", bone), ("ghost", ghost), ("arrow", arrow), ("marker", marker), ("tendon", tendon)];
        for (name, [r, g, b]) in named.into_iter().chain(more) {
            let number = |value: f32| if value.fract() == 0.0 { format!("{value:.1}") } else { value.to_string() };
            let text = format!("{name}: [{}, {}, {}]", number(r), number(g), number(b));
            assert!(palette.contains(&text), "{text}");
        }
    }
    assert!(
        View::NAMED.iter().all(|(name, _)| camera.contains(&format!("{name}: [")) || camera.contains(&format!("\"{name}\": [")))
    );
    // Lightness rises evenly from end to end.
    let light = |share: f64| heat(share).iter().zip([0.2126, 0.7152, 0.0722]).map(|(part, weight)| part * weight).sum::<f32>();
    assert!((0..20).all(|step| light(f64::from(step) / 20.0) < light(f64::from(step + 1) / 20.0)));
    assert_eq!(heat(f64::NAN), heat(0.0));
}

#[test]
fn every_view_shows_the_body_whole() {
    let scene = scenes(2, Colouring::Activation).remove(0);
    let empty = Scene { solids: Vec::new(), shells: Default::default(), tubes: Vec::new(), ..scene.clone() };
    for (name, view) in View::NAMED {
        for (width, height) in [(160, 120), (102, 160)] {
            let options = Options { view, width, height, labels: false, ..SMALL };
            let [with, without] = [&scene, &empty].map(|scene| scene.render(&options).unwrap().into_bytes());
            let drawn = |place: usize| with[3 * place..3 * place + 3] != without[3 * place..3 * place + 3];
            let (width, height) = (width as usize, height as usize);
            let count = (0..width * height).filter(|place| drawn(*place)).count();
            let body = count as f64 / (width * height) as f64;
            assert!((0.02..0.5).contains(&body), "{name}, {width} x {height}: {body} of the picture");
            // The shadow may leave the picture, below.
            let cut = (0..width * height / 2).filter(|place| place % width == 0 || place / width == 0).any(drawn);
            assert!(!cut, "{name}, {width} x {height}: cut off");
        }
    }
}

#[test]
fn muscles_have_the_colour_of_what_is_asked_for() {
    let pictures = Colouring::NAMED.map(|(_, colouring)| {
        let scene = scenes(2, colouring).pop().unwrap();
        scene.render(&Options { labels: false, ..SMALL }).unwrap()
    });
    for (index, first) in pictures.iter().enumerate() {
        for second in &pictures[index + 1..] {
            assert!(difference(first, second.bytes()) > 0.05);
        }
    }
}

#[test]
fn what_is_behind_the_camera_is_cut_off() {
    let mut scene = scenes(2, Colouring::Activation).remove(0);
    let camera = Camera::new(View::Front, scene.centre, [160.0, 200.0]);
    let wall = scene::Placed {
        form: scene::Form::Box,
        place: camera.eye - Vector::new(1.0, 0.0, 0.5),
        turn: nalgebra::Matrix3::identity(),
        size: Vector::new(2.0, 0.4, 0.3),
        half: 0.0,
        paint: scene::Paint::Scenery,
    };
    scene.solids = vec![wall];
    (scene.shells, scene.tubes, scene.labels) = (Default::default(), Vec::new(), Vec::new());
    let options = Options { view: View::Front, labels: false, ..SMALL };
    let picture = scene.render(&options).unwrap();
    scene.solids.clear();
    assert!(difference(&picture, scene.render(&options).unwrap().bytes()) > 10.0);
}

#[test]
fn numbers_that_are_none_draw_nothing() {
    let mut scene = scenes(2, Colouring::Activation).remove(0);
    for placed in scene.solids.iter_mut().chain(scene.shells.iter_mut().flatten()) {
        placed.place.x = f32::NAN;
    }
    scene.tubes.iter_mut().for_each(|tube| tube.line[0] = Vector::repeat(f32::INFINITY));
    scene.labels.iter_mut().for_each(|label| label.at.y = f32::NAN);
    scene.render(&SMALL).unwrap();
    scene.centre.x = f32::NAN;
    scene.render(&SMALL).unwrap();
}

#[test]
fn sizes_are_checked() {
    let scene = scenes(2, Colouring::Activation).remove(0);
    for (width, height) in [(0, 10), (10, 0), (LARGEST + 1, 10)] {
        let found = scene.render(&Options { width, height, ..SMALL }).unwrap_err();
        assert_eq!(found, PictureError::Size(width, height));
    }
    assert!(scene.render(&Options { width: 1, height: 1, ..SMALL }).is_ok());
}

#[test]
fn a_strip_of_a_long_episode_keeps_few_scenes() {
    let scene = scenes(2, Colouring::Activation).remove(0);
    let mut strip = Strip::default();
    (0..3001).for_each(|step| strip.look(Scene { time: 0.01 * f64::from(step), tubes: Vec::new(), ..scene.clone() }));
    let times: Vec<f64> = strip.scenes(4).iter().map(|scene| scene.time).collect();
    for (time, wanted) in times.iter().zip([0.0, 10.0, 20.0, 30.0]) {
        assert!((time - wanted).abs() < 0.05, "{times:?}");
    }
    assert!(Strip::default().scenes(4).is_empty());
    assert_eq!(film_strip(&[], &SMALL).unwrap_err(), PictureError::Empty);
    let film = film_strip(&strip.scenes(9), &Options { width: 50, height: 40, ..SMALL }).unwrap();
    // Eight frames of 26 pixels with gaps of three, in two rows.
    assert_eq!((film.width(), film.height()), (8 * 29 - 3, 2 * 43 - 3));
}

/// Control and activation are told apart: the state has both.
#[test]
fn excitation_is_the_control() {
    let mut shown = Vec::new();
    crouching(2, |_, snapshot| {
        let state = State { control: vec![1.0; snapshot.state.control.len()], ..snapshot.state.clone() };
        let snapshot = msk_runtime::body::sensors::Snapshot { state: &state, ..*snapshot };
        let renderer = Renderer::of(&snapshot, &[], Colouring::Excitation);
        shown.push(renderer.scene_of(0.0, &snapshot, None).tubes[0].colour);
    });
    assert_eq!(shown, [heat(1.0); 2]);
}
