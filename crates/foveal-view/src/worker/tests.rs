//! The thread as the window sees it: requests in, news out. Needs a graphics adapter.

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::bail;
use foveal::{
    Antialiasing, Culling, EnvironmentMap, EnvironmentSource, RateSource, Settings, Shading,
};
use foveal_generate as generate;
use foveal_measure::Finding;
use foveal_scene::Clip;

use super::{Compared, News, Request, Shown, Worker};
use crate::app::tests::host;
use crate::capture::{Ended, Job, turntable};
use crate::{Format, Host, Loaded, Recording};

/// A recording that goes nowhere.
struct Kept;

impl Recording for Kept {
    fn name(&self) -> String {
        "nowhere".to_owned()
    }

    fn keeps_parts(&self) -> bool {
        true
    }

    fn add(&mut self, rgba: &[u8]) -> anyhow::Result<()> {
        anyhow::ensure!(rgba.len() == 64 * 40 * 4, "of another size");
        Ok(())
    }

    fn finish(self: Box<Self>) -> anyhow::Result<()> {
        Ok(())
    }
}

fn worker() -> Worker {
    let load = |name: &str| {
        if name == "bad" {
            bail!("there is no scene 'bad'");
        }
        let scene = generate::cornell();
        let camera = scene.cameras[0].clone();
        Ok(Loaded {
            scene,
            camera,
            clip: Clip::default(),
        })
    };
    let host = Host {
        fit: false,
        load: Box::new(load),
        record: Box::new(|_, _, _| Ok(Box::new(Kept))),
        ..host()
    };
    Worker::start(Arc::new(host), || ()).expect("threads can be started")
}

fn request() -> Request {
    Request {
        settings: Settings::default().with(|s| {
            s.picture.width = 64;
            s.picture.height = 40;
            s.culling.mode = Culling::Occlusion;
        }),
        reference: None,
        camera: generate::cornell().cameras[0].clone(),
        frozen: false,
        boxes: true,
        depth: true,
        time_s: 0.0,
        clip: Clip::default(),
        always: false,
    }
}

/// The first news that `wanted` takes.
fn next<T>(worker: &Worker, mut wanted: impl FnMut(News) -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = worker.news().find_map(&mut wanted) {
            return found;
        }
        assert!(start.elapsed() < Duration::from_secs(60), "no news");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn picture(worker: &Worker) -> Box<Shown> {
    next(worker, |news| match news {
        News::Picture(shown) => Some(shown),
        News::Failed(cause) => panic!("{cause}"),
        _ => None,
    })
}

fn failure(worker: &Worker) -> String {
    next(worker, |news| match news {
        News::Failed(cause) | News::LoadFailed(_, cause) => Some(cause),
        _ => None,
    })
}

#[test]
fn pairs_with_frozen_culling_are_not_those_without() {
    let (before, frozen) = (
        request(),
        Request {
            frozen: true,
            ..request()
        },
    );
    let later = Request {
        time_s: 1.0,
        ..request()
    };
    let measuring = super::measuring::Measuring::new(&before);
    assert!(measuring.is_of(&later) && !measuring.is_of(&frozen));
    assert!(!frozen.shows_the_same(&before));
}

#[test]
fn errors_are_news_and_work_goes_on() {
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.draw(request());
    let shown = picture(&worker);
    assert_eq!((shown.picture.width, shown.picture.height), (64, 40));
    assert_eq!(shown.picture.bytes.len(), 64 * 40 * 4);
    let found = shown.culling.expect("culling is on");
    assert_eq!(shown.boxes.len() as u64, found.stats.occludees);
    let depth = shown.depth.expect("depth was asked for");
    assert_eq!((depth.width, depth.height), found.buffer);
    assert_eq!(depth.near_over_distance.len(), 16 * 10);

    worker.load("bad".to_owned());
    assert!(failure(&worker).contains("'bad'"));
    // What no device can do is an error too, after which there is a new device with the old scene.
    let too_large = request().settings.with(|s| s.picture.width = 1 << 20);
    worker.draw(Request {
        settings: too_large,
        ..request()
    });
    assert!(failure(&worker).contains("width"));
    worker.draw(request());
    assert_eq!(picture(&worker).picture.bytes, shown.picture.bytes);
}

#[test]
fn settings_that_fail_leave_no_other_environment_behind() {
    let load = |_: &str| {
        let scene = generate::materials_grid();
        let camera = scene.cameras[0].clone();
        Ok(Loaded {
            scene,
            camera,
            clip: Clip::default(),
        })
    };
    let environment = |settings: &Settings| {
        let texel = match settings.lighting.environment_image.as_str() {
            "red.hdr" => [1.0, 0.0, 0.0],
            _ => [0.0, 0.0, 1.0],
        };
        Ok(Some(EnvironmentMap::new(16, 8, &[texel; 16 * 8])?))
    };
    let host = Host {
        fit: false,
        load: Box::new(load),
        environment,
        ..host()
    };
    let worker = Worker::start(Arc::new(host), || ()).expect("threads can be started");
    worker.load("grid".to_owned());
    let lit_by = |name: &str| {
        let mut request = request();
        request.camera = generate::materials_grid().cameras[0].clone();
        request.settings.lighting.environment = EnvironmentSource::Image;
        request.settings.lighting.environment_image = name.to_owned();
        request
    };
    worker.draw(lit_by("red.hdr"));
    let first = picture(&worker);
    let mut wrong = lit_by("blue.hdr");
    wrong.settings.lighting.environment_intensity = -1.0;
    worker.draw(wrong);
    assert!(failure(&worker).contains("environment-intensity"));
    worker.draw(lit_by("red.hdr"));
    assert!(picture(&worker).picture.bytes == first.picture.bytes);
    worker.draw(lit_by("blue.hdr"));
    // The view that stood still may be drawn a few times more before.
    let mut pictures = (0..40).map(|_| picture(&worker));
    assert!(pictures.any(|shown| shown.picture.bytes != first.picture.bytes));
}

#[test]
fn the_reference_is_drawn_beside_and_flip_tells_them_apart() {
    let worker = worker();
    worker.load("cornell".to_owned());
    let compared = |chosen: Settings| {
        worker.draw(Request {
            settings: chosen.clone(),
            reference: Some(request().settings),
            ..request()
        });
        next(&worker, |news| match news {
            // The request before may be drawn once more.
            News::Picture(shown) if shown.request.settings != chosen => None,
            News::Picture(shown) => shown.flip.map(|flip| (flip, shown.reference.is_some())),
            News::Failed(cause) => panic!("{cause}"),
            _ => None,
        })
    };
    assert_eq!(compared(request().settings), (0.0, true));
    let coarse = request().settings.with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Radii;
        s.coarse.fovea_inner = 0.0;
        s.rate.force = true;
    });
    let (flip, _) = compared(coarse);
    assert!(flip > 0.0, "{flip}");
}

#[test]
fn frozen_culling_stays_as_it_was_found() {
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.draw(request());
    let before = picture(&worker).culling;
    let mut behind = request();
    behind.frozen = true;
    // Looking away, all would be outside.
    behind.camera.world_from_view *= glam::Mat4::from_rotation_y(std::f32::consts::PI);
    worker.draw(behind.clone());
    let frozen = next(&worker, |news| match news {
        News::Picture(shown) if shown.request.camera == behind.camera => Some(shown.culling),
        _ => None,
    });
    let counts = |found: &Option<foveal::CullingStats>| found.map(|found| found.stats);
    assert_eq!(counts(&frozen), counts(&before));
    behind.frozen = false;
    worker.draw(behind);
    let thawed = next(&worker, |news| match news {
        News::Picture(shown) if counts(&shown.culling) != counts(&before) => Some(shown.culling),
        _ => None,
    });
    let outside = |found: &Option<foveal::CullingStats>| {
        found.map_or(0, |found| found.stats.occludees_outside)
    };
    assert!(outside(&thawed) > outside(&before));
}

#[test]
fn a_lost_device_is_news_and_the_picture_is_drawn_on_a_new_one() {
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.draw(request());
    let before = picture(&worker);
    worker.lose_device();
    assert!(failure(&worker).contains("lost"));
    // Nobody asked again.
    assert_eq!(picture(&worker).picture.bytes, before.picture.bytes);
}

/// The comparison of the request's settings with a reference, once it says something.
fn compared(worker: &Worker, chosen: Settings, reference: Settings) -> Compared {
    worker.load("cornell".to_owned());
    worker.draw(Request {
        settings: chosen,
        reference: Some(reference),
        ..request()
    });
    next(worker, |news| match news {
        News::Picture(shown) => shown.compared.filter(|c| c.pairs >= 20),
        News::Failed(cause) => panic!("{cause}"),
        _ => None,
    })
}

#[test]
fn equal_settings_are_no_difference_after_twenty_frames() {
    let settings = request().settings.with(|s| {
        s.picture.width = 320;
        s.picture.height = 200;
    });
    let compared = compared(&worker(), settings.clone(), settings);
    assert_eq!(compared.pairs, 20);
    let frame = compared.frame.expect("twenty pairs are enough to tell");
    assert_eq!(frame.finding, Finding::NoDifference, "{frame:?}");
}

#[test]
fn a_picture_of_nine_times_the_samples_is_slower() {
    let settings = request().settings.with(|s| {
        s.picture.width = 320;
        s.picture.height = 200;
    });
    let supersampled = settings.clone().with(|s| {
        s.antialiasing.mode = Antialiasing::Ssaa;
        s.antialiasing.samples = 9;
    });
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.draw(Request {
        settings: supersampled,
        reference: Some(settings),
        ..request()
    });
    let found = next(&worker, |news| match news {
        News::Picture(shown) => shown.compared.filter(|c| c.is_done).and_then(|c| c.frame),
        News::Failed(cause) => panic!("{cause}"),
        _ => None,
    });
    assert_eq!(found.finding, Finding::Slower, "{found:?}");
}

#[test]
fn the_eye_judges_both_sides_at_the_display_of_the_settings() {
    let reference = request().settings.with(|s| {
        s.picture.width = 320;
        s.picture.height = 200;
    });
    let coarse = reference.clone().with(|s| {
        s.shading.mode = Shading::Coarse;
        s.coarse.source = RateSource::Constant;
        s.coarse.constant_level = 4;
        s.eye.display = foveal::Display::Fhd24;
    });
    let worker = worker();
    worker.load("cornell".to_owned());
    let judged = |chosen: &Settings| {
        let request = Request {
            settings: chosen.clone(),
            reference: Some(reference.clone()),
            ..request()
        };
        worker.draw(request.clone());
        let found = next(&worker, |news| match news {
            News::Quality(quality) => Some(quality),
            News::Failed(cause) => panic!("{cause}"),
            _ => None,
        });
        assert!(found.request.shows_the_same(&request));
        found
    };
    let found = judged(&coarse);
    assert_eq!(found.display, "fhd-24");
    assert!(found.jod < 9.9, "{}", found.jod);
}

/// A capture of a turn with these frames.
fn job(frames: u32) -> Job {
    let scene = generate::cornell();
    let camera = &request().camera;
    Job {
        settings: request().settings,
        clip: Clip::default(),
        poses: turntable(camera, scene.bounds(), frames, (0.0, 30.0, false)),
        format: Format::Pictures,
        per_second: 30.0,
    }
}

#[test]
fn a_capture_tells_of_each_frame_and_of_its_end() {
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.capture(job(5));
    let mut written = Vec::new();
    let ended = next(&worker, |news| match news {
        News::Captured(frames, of) => {
            assert_eq!(of, 5);
            written.push(frames);
            None
        }
        News::CaptureEnded(ended) => Some(ended),
        _ => None,
    });
    assert_eq!(ended, Ended::Done("nowhere".to_owned()));
    written.retain(|frames| *frames > 0);
    assert_eq!(written, [1, 2, 3, 4, 5]);
    // What is asked for next is drawn again.
    worker.draw(request());
    assert_eq!(picture(&worker).request.camera, request().camera);
}

#[test]
fn a_capture_is_cancelled_between_frames_and_the_view_comes_back() {
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.draw(request());
    worker.capture(job(100_000));
    next(&worker, |news| match news {
        News::Captured(frames, _) => (frames >= 2).then_some(()),
        _ => None,
    });
    worker.cancel_capture();
    let ended = next(&worker, |news| match news {
        News::CaptureEnded(ended) => Some(ended),
        _ => None,
    });
    assert!(
        matches!(&ended, Ended::Cancelled(text) if text.contains("of 100000")),
        "{ended:?}"
    );
    assert_eq!(picture(&worker).request.camera, request().camera);
}

#[test]
fn a_capture_that_is_cancelled_before_it_begins_ends_too() {
    let worker = worker();
    worker.load("cornell".to_owned());
    worker.capture(job(3));
    worker.cancel_capture();
    let ended = next(&worker, |news| match news {
        News::CaptureEnded(ended) => Some(ended),
        _ => None,
    });
    assert!(matches!(ended, Ended::Cancelled(_)), "{ended:?}");
    worker.draw(request());
    assert_eq!(picture(&worker).request.camera, request().camera);
}

#[test]
fn a_capture_that_cannot_be_written_says_why() {
    let worker = worker();
    worker.load("cornell".to_owned());
    let mut larger = job(3);
    larger.settings.picture.width = 80;
    worker.capture(larger);
    let ended = next(&worker, |news| match news {
        News::CaptureEnded(ended) => Some(ended),
        _ => None,
    });
    assert_eq!(ended, Ended::Failed("of another size".to_owned()));
}
