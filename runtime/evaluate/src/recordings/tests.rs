use super::*;
use crate::trace::{opensim, tests::trace};

#[test]
fn what_a_trace_exports_is_read() {
    for file in opensim(&trace()) {
        let found = Recording::read(file.name, file.text.as_bytes()).unwrap();
        assert_eq!((found.rows(), found.degrees), (4, file.name == "coordinates.mot"), "{}", file.name);
    }
    let activations = opensim(&trace()).into_iter().find(|file| file.name == "activations.sto").unwrap();
    let found = Recording::read("a.STO", activations.text.as_bytes()).unwrap();
    assert_eq!(found.column("soleus_l").unwrap(), [0.0, 0.25, 0.5, 0.75]);
    assert_eq!(found.column("knee"), None);
}

#[test]
fn markers_have_three_columns() {
    let text = "PathFileType\t4\t(X/Y/Z)\tw.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t2\t2\tmm\n\
                Frame#\tTime\tASIS\t\t\tHEEL\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n1\t0.00\t1\t2\t3\t4\t5\t6\t\n2\t0.01\t1.5\t2\t3\t\t\t\n";
    let found = Recording::read("w.trc", text.as_bytes()).unwrap();
    assert_eq!(found.names[..5], ["frame", "time", "ASIS.x", "ASIS.y", "ASIS.z"]);
    assert_eq!(found.column("ASIS.x").unwrap(), [1.0, 1.5]);
    assert!(found.column("HEEL.z").unwrap()[0] == 6.0 && found.column("HEEL.z").unwrap()[1].is_nan());
}

#[test]
fn envelopes_come_from_named_columns() {
    let text = "\u{feff}percent;Soleus;\"Tib. ant.\"\n0;0.1;0.5\n50;0.9;\n100;0.1;0.4\n";
    let found = Recording::read("gait.csv", text.as_bytes()).unwrap();
    let pair = |muscle: &str, column: &str| (muscle.to_owned(), column.to_owned());
    let envelopes = found.envelopes(&[pair("soleus_r", "Soleus"), pair("tibant_r", "Tib. ant.")]).unwrap();
    assert_eq!((envelopes[0].muscle.as_str(), envelopes[0].values.as_slice()), ("soleus_r", &[0.1, 0.9, 0.1][..]));
    assert_eq!(envelopes[1].values, [0.5, 0.4]);
    let error = found.envelopes(&[pair("a", "b")]).unwrap_err().to_string();
    assert_eq!(error, "has no column `b`; it has percent, Soleus, Tib. ant.");
}

#[test]
fn what_is_no_recording_is_refused_with_its_line() {
    let error = |name: &str, text: &str| Recording::read(name, text.as_bytes()).unwrap_err().to_string();
    assert_eq!(error("x.c3d", "percent,Soleus"), "has no mark of a C3D file in its second byte");
    assert_eq!(Recording::read("x.csv", &[0xFF]), Err(RecordingError::Text));
    assert!(error("x", "").starts_with("has an unknown format") && error("x.mat", "").starts_with("has an unknown format"));
    assert_eq!(error("x.sto", "version=1\n"), "has no line `endheader`");
    assert_eq!(error("x.mot", "endheader\n"), "has no names of columns");
    assert_eq!(error("x.mot", "endheader\ntime a\n0 1\n1\n"), "line 4 has 1 cells, expected 2");
    assert_eq!(error("x.csv", "a,b\n1,x\n"), "line 2: expected a number, found `x`");
    assert_eq!(error("x.csv", ""), "has no names of columns");
    assert_eq!(error("x.trc", "a\nb\nc\nd\n"), "has no columns `Frame#` and `Time` in its fourth line");
    assert_eq!(error("x.trc", "a"), "has no line of marker names");
}
