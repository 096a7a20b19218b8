//! Values as the command line spells them. Each parser's message completes clap's «invalid value
//! '…' for '--flag'».

mod variants;

pub use variants::VariantParser;

use foveal_scene::{Camera, Projection};
use foveal_vdp::FRAME_RATES;
use glam::{Mat4, Vec3};

/// Width and height in pixels: `1920x1080`.
pub fn size(text: &str) -> Result<(u32, u32), String> {
    let number = |text: &str| {
        text.parse::<u32>()
            .map_err(|_| format!("'{text}' is not a number of pixels; a size looks like 1920x1080"))
    };
    match text.split_once(['x', 'X']) {
        Some((width, height)) => Ok((number(width)?, number(height)?)),
        None => Err("a size looks like 1920x1080".to_owned()),
    }
}

/// Most pixels of a window's side: what graphics devices draw.
const MOST_WINDOW: u32 = 16_384;

/// Width and height of a window in pixels.
pub fn window(text: &str) -> Result<(u32, u32), String> {
    let (width, height) = size(text)?;
    let sides = 1..=MOST_WINDOW;
    if sides.contains(&width) && sides.contains(&height) {
        Ok((width, height))
    } else {
        Err(format!("a window has 1 to {MOST_WINDOW} pixels a side"))
    }
}

/// Any finite number.
pub fn finite(text: &str) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => Err("the number must be finite".to_owned()),
        Err(_) => Err("not a number".to_owned()),
    }
}

/// A point or a direction: `x,y,z`.
pub fn vec3(text: &str) -> Result<Vec3, String> {
    let numbers = text.split(',').map(finite).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => Err("three numbers are needed: x,y,z".to_owned()),
    }
}

/// A camera in full: how it projects, then twelve numbers of its place.
pub fn exact_camera(text: &str) -> Result<Camera, String> {
    let (kind, numbers) = text.split_once(',').unwrap_or((text, ""));
    let numbers = (numbers.split(',').map(finite)).collect::<Result<Vec<_>, _>>();
    let (projection, place) = match (kind, numbers.as_deref()) {
        ("perspective", Ok([fov_y_rad, near_m, place @ ..]))
            if *fov_y_rad > 0.0 && *fov_y_rad < std::f32::consts::PI && *near_m > 0.0 =>
        {
            let projection = Projection::Perspective {
                fov_y_rad: *fov_y_rad,
                near_m: *near_m,
            };
            (projection, place)
        }
        ("orthographic", Ok([height_m, near_m, far_m, place @ ..]))
            if *height_m > 0.0 && far_m > near_m =>
        {
            let projection = Projection::Orthographic {
                height_m: *height_m,
                near_m: *near_m,
                far_m: *far_m,
            };
            (projection, place)
        }
        _ => {
            return Err("it begins with perspective,FOV_RAD,NEAR_M or orthographic,HEIGHT_M,NEAR_M,FAR_M, all possible".to_owned());
        }
    };
    let &[rx, ry, rz, ux, uy, uz, bx, by, bz, ex, ey, ez] = place else {
        return Err("twelve numbers follow: right, up, back and eye".to_owned());
    };
    Ok(Camera {
        name: "exact".to_owned(),
        world_from_view: Mat4::from_cols_array_2d(&[
            [rx, ry, rz, 0.0],
            [ux, uy, uz, 0.0],
            [bx, by, bz, 0.0],
            [ex, ey, ez, 1.0],
        ]),
        projection,
    })
}

/// A place in the picture: `x,y`.
pub fn vec2(text: &str) -> Result<[f32; 2], String> {
    let numbers = text.split(',').map(finite).collect::<Result<Vec<_>, _>>()?;
    match numbers[..] {
        [x, y] => Ok([x, y]),
        _ => Err("two numbers are needed: x,y".to_owned()),
    }
}

/// A vertical field of view in degrees, in (0, 180).
pub fn fov_deg(text: &str) -> Result<f32, String> {
    let degrees = finite(text)?;
    if degrees > 0.0 && degrees < 180.0 {
        Ok(degrees)
    } else {
        Err("the field of view must lie between 0 and 180 degrees".to_owned())
    }
}

/// A time in seconds, 0 or later.
pub fn time_s(text: &str) -> Result<f32, String> {
    match finite(text)? {
        seconds if seconds >= 0.0 => Ok(seconds),
        _ => Err("the time must be 0 or later".to_owned()),
    }
}

/// A positive number.
pub fn positive(text: &str) -> Result<f32, String> {
    match finite(text)? {
        value if value > 0.0 => Ok(value),
        _ => Err("the number must be greater than 0".to_owned()),
    }
}

/// Frames per second of a video whose quality is measured.
pub fn metric_rate(text: &str) -> Result<f32, String> {
    let rate = finite(text)?;
    if FRAME_RATES.contains(&rate) {
        return Ok(rate);
    }
    let (least, most) = (FRAME_RATES.start(), FRAME_RATES.end());
    Err(format!(
        "the rate must be {least} to {most} frames per second"
    ))
}

/// A finite number of 0 or more.
pub fn non_negative(text: &str) -> Result<f32, String> {
    match finite(text)? {
        value if value >= 0.0 => Ok(value),
        _ => Err("the number must be 0 or more".to_owned()),
    }
}

/// A number of 0 or more; `inf` is allowed.
pub fn threshold(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value >= 0.0 => Ok(value),
        _ => Err("a number of 0 or more is needed".to_owned()),
    }
}

/// An amount of memory: `512MB`, `1.5 GB`, `2GiB`, or a number of bytes.
pub fn bytes(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, f64); 9] = [
        ("KIB", 1024.0),
        ("MIB", 1_048_576.0),
        ("GIB", 1_073_741_824.0),
        ("TIB", 1_099_511_627_776.0),
        ("KB", 1e3),
        ("MB", 1e6),
        ("GB", 1e9),
        ("TB", 1e12),
        ("B", 1.0),
    ];
    let upper = text.trim().to_ascii_uppercase();
    let unit = UNITS.iter().find(|(unit, _)| upper.ends_with(unit));
    let (number, factor) = match unit {
        Some((unit, factor)) => (&upper[..upper.len() - unit.len()], *factor),
        None => (upper.as_str(), 1.0),
    };
    match number.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 && value * factor < 1e19 => {
            Ok((value * factor) as u64)
        }
        _ => Err("an amount of memory looks like 512MB or 1.5GB".to_owned()),
    }
}

/// Most frames of one sequence: each has a file's name and figures in memory.
const MOST_FRAMES: u32 = 1_000_000;

/// A number of frames, none or as many as one sequence has.
pub fn frame_count(text: &str) -> Result<u32, String> {
    match text.trim().parse::<u32>() {
        Ok(count) if count <= MOST_FRAMES => Ok(count),
        _ => Err(format!("a number from 0 to {MOST_FRAMES} is needed")),
    }
}

/// Most point lights that a renderer takes.
const MOST_LIGHTS: u32 = 16_384;

/// A number of point lights.
pub fn point_lights(text: &str) -> Result<u32, String> {
    match text.trim().parse::<u32>() {
        Ok(count) if count <= MOST_LIGHTS => Ok(count),
        _ => Err(format!("a number from 0 to {MOST_LIGHTS} is needed")),
    }
}

/// Frame numbers `A..B`, without B, or `N` for `0..N`. Never empty.
pub fn frames(text: &str) -> Result<std::ops::Range<u32>, String> {
    let number = |text: &str| {
        text.trim()
            .parse::<u32>()
            .map_err(|_| format!("'{text}' is not a frame number; try 0..100 or 100"))
    };
    let range = match text.split_once("..") {
        Some((first, end)) => number(first)?..number(end)?,
        None => 0..number(text)?,
    };
    if range.is_empty() {
        return Err("the range holds no frame; its end is not part of it".to_owned());
    }
    let count = range.end - range.start;
    if count > MOST_FRAMES {
        return Err(format!(
            "the range holds {count} frames, the limit is {MOST_FRAMES}; draw it in several runs"
        ));
    }
    Ok(range)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn good_values_are_read() {
        assert_eq!(size("1920x1080"), Ok((1920, 1080)));
        assert_eq!(window("16384x1"), Ok((16_384, 1)));
        assert_eq!(vec3("-1, 2.5,3e1"), Ok(Vec3::new(-1.0, 2.5, 30.0)));
        assert_eq!(frames("7"), Ok(0..7));
        assert_eq!(frames("5..7"), Ok(5..7));
        assert_eq!(
            frames("4294000000..4294967295"),
            Ok(4_294_000_000..u32::MAX)
        );
        assert_eq!(point_lights("16384"), Ok(16_384));
        for (text, size) in [
            ("7", 7),
            ("512MB", 512_000_000),
            ("1.5 gb", 1_500_000_000),
            ("2GiB", 2 << 30),
            ("0B", 0),
        ] {
            assert_eq!(bytes(text), Ok(size), "{text}");
        }
        assert_eq!(threshold("inf"), Ok(f64::INFINITY));
        assert_eq!(fov_deg("60"), Ok(60.0));
    }

    #[test]
    fn bad_values_are_refused() {
        for text in ["", "12", "x", "1x", "-1x2", "1.5x2", "1x2x3"] {
            assert!(size(text).is_err(), "{text}");
        }
        for text in ["1280", "0x720", "1280x0", "16385x720", "1280x70000"] {
            assert!(window(text).is_err(), "{text}");
        }
        for text in [
            "", "1,2", "1,2,3,4", "1,2,nan", "inf,0,0", "1,,2", "1e99,0,0",
        ] {
            assert!(vec3(text).is_err(), "{text}");
        }
        for text in ["0", "180", "-5", "nan"] {
            assert!(fov_deg(text).is_err(), "{text}");
        }
        for text in ["", "0", "5..5", "7..5", "..", "1..", "-1..3", "1..=3"] {
            assert!(frames(text).is_err(), "{text}");
        }
        for text in ["", "GB", "-1GB", "1.5.2MB", "inf", "1e30", "2 PB"] {
            assert!(bytes(text).is_err(), "{text}");
        }
        assert!(frames("0..4294967295").is_err_and(|e| e.contains("the limit is 1000000")));
        assert!(point_lights("4294967295").is_err_and(|e| e.contains("16384")));
        assert!(frame_count("1000001").is_err_and(|e| e.contains("1000000")));
        assert!(threshold("-1").is_err() && threshold("nan").is_err());
        assert!(positive("0").is_err() && time_s("-1").is_err());
    }
}
