//! Recordings for `foveal cull`: an error or subjects, which are culled.

use foveal_cull::{Culler, FrameOptions, SingleThread, View, Visibility};
use foveal_host::culling::mocrec;

/// Reads a recording and replays it.
pub fn records(input: &[u8]) {
    let Ok(recording) = mocrec::Recording::parse(input) else {
        return;
    };
    let Ok(subjects) = mocrec::subjects("fuzz", &recording) else {
        return;
    };
    let Ok(mut culler) = Culler::new(64, 48) else {
        panic!("a culler of 64 x 48 pixels");
    };
    for subject in &subjects {
        let options = FrameOptions::default();
        for eye in &subject.eyes {
            let view = View::mono(eye.eye);
            // A near plane may be beyond what a view can have.
            let _ = culler.rasterize(&view, &subject.occluders.set, &options, &SingleThread);
            let boxes = &subject.occludees.boxes;
            let mut results = vec![Visibility::Visible; boxes.len()];
            let asked = culler.query(boxes, [0.0; 3], &mut results);
            assert_eq!(asked, Ok(()));
            let _ = mocrec::Agreement::of(&subject.occludees.recorded, &results);
        }
    }
}

/// Two draws (one with a matrix), both kinds of query, a clear.
fn recording() -> Vec<u8> {
    let mut bytes = 0xA701_B600_u32.to_le_bytes().to_vec();
    let floats = |bytes: &mut Vec<u8>, values: &[f32]| {
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    };
    let words = |bytes: &mut Vec<u8>, values: &[i32]| {
        bytes.extend(values.iter().flat_map(|v| v.to_le_bytes()));
    };
    let triangle = |bytes: &mut Vec<u8>, tag: u8, matrix: bool| {
        bytes.push(tag);
        words(bytes, &[-1, 4, 12]);
        floats(bytes, &[0., 0., 1., 1., 0., 1., 0., 1., 1., 1., 1., 2.]);
        words(bytes, &[2, 0, 1, 2, 2, 1, 3]);
        bytes.push(u8::from(matrix));
        if matrix {
            let m = [
                1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 1., 0.5, 0., 0., 1.,
            ];
            floats(bytes, &m);
        }
        words(bytes, &[0, 1, 12, 4, 8]);
    };
    floats(&mut bytes, &[0.1]);
    words(&mut bytes, &[64, 64]);
    triangle(&mut bytes, 0, false);
    triangle(&mut bytes, 0, true);
    triangle(&mut bytes, 2, false);
    bytes.push(3);
    triangle(&mut bytes, 0, true);
    bytes.push(1);
    words(&mut bytes, &[0]);
    floats(&mut bytes, &[-0.5, -0.5, 0.5, 0.5, 2.0]);
    bytes.push(0x7F);
    bytes
}

pub(super) fn seeds() -> Vec<Vec<u8>> {
    vec![recording()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_seed_is_a_good_recording() {
        let whole = mocrec::Recording::parse(&recording());
        assert_eq!(whole.map(|w| w.records.len()).ok(), Some(6));
    }
}
