//! Where light changes when a thing that casts shadows has moved.

use foveal_scene::Aabb;
use glam::Vec3;

use crate::lights::LightUniform;

/// Most places that are told apart; nearer ones are put together.
const MOST: usize = 12;
/// A place that something farther makes fade far sees what is nearer fade this much farther than by
/// itself: 1 over the shaders' `CONTACT_SLACK`.
const AMONG_OTHERS: f32 = 2.0;
/// Most by which a place in a cube's side is farther from the lamp than along the side's axis.
const TO_CORNERS: f32 = 1.7321;

/// A sphere: centre and radius in metres, world space.
pub(crate) type Place = [f32; 4];

/// Spheres that hold all places where lookups find shadows of the boxes, by lights whose shadows are in
/// tiles; `scene` is the box around everything. `lamps`: radius of point and spot lights in metres, and
/// tangent of half the angle that directional ones fill. `beside`: metres by which a light's lookups
/// reach beside the place that they are for; `None` without tiles.
pub(super) fn changed_places(
    lights: &[LightUniform],
    lamps: [f32; 2],
    boxes: &[Aabb],
    scene: &Aabb,
    mut beside: impl FnMut(usize) -> Option<f32>,
) -> Vec<Place> {
    let mut places: Vec<Place> = Vec::new();
    for (number, light) in lights.iter().enumerate() {
        let Some(beside) = beside(number) else {
            continue;
        };
        for b in boxes.iter().filter(|b| reaches(light, b)) {
            add_place(&mut places, shadow_of(light, lamps, beside, b, scene), MOST);
        }
    }
    places
}

/// Adds a place, and where there are more than `most` puts the nearest together.
pub(crate) fn add_place(places: &mut Vec<Place>, place: Place, most: usize) {
    if places.iter().any(|p| holds(*p, place)) {
        return;
    }
    places.push(place);
    if places.len() > most {
        join_nearest(places);
    }
}

fn reaches(light: &LightUniform, b: &Aabb) -> bool {
    let at = Vec3::from(light.position);
    light.is_directional()
        || at.clamp(b.min, b.max).distance_squared(at) < light.range * light.range
}

/// A sphere around a box and its shadow, with what it blurs into.
fn shadow_of(
    light: &LightUniform,
    [lamp, sun]: [f32; 2],
    beside: f32,
    b: &Aabb,
    scene: &Aabb,
) -> Place {
    let (center, radius) = (b.center(), b.half_extent().length());
    if light.is_directional() {
        // The ray ends where the scene does.
        let along = Vec3::from(light.direction);
        let beyond = scene.center() - center;
        let reach = along.dot(beyond) + along.abs().dot(scene.half_extent());
        let half = 0.5 * reach.max(0.0);
        let fades = AMONG_OTHERS * sun * 2.0 * half + beside;
        return (center + along * half)
            .extend(half + radius + fades)
            .to_array();
    }
    let apex = Vec3::from(light.position);
    let to = center - apex;
    let distance = to.length();
    // Past an edge, the lamp's border is seen so far beside the shadow at the range.
    let past_edges = (light.range / (distance - radius).max(1e-6) - 1.0).max(0.0);
    // A place within the range looks up ones that may lie beyond it.
    let fades = AMONG_OTHERS * TO_CORNERS * lamp * past_edges + 2.0 * beside;
    if distance <= radius || fades >= light.range {
        return apex.extend(light.range).to_array();
    }
    // The shadow is a cone's part between the box and the range.
    let (near, far) = ((distance - radius).max(0.0), light.range);
    let sine = radius / distance;
    let cosine = (1.0 - sine * sine).sqrt();
    let middle = 0.5 * (near + far);
    let rim = |r: f32| (r * cosine - middle).hypot(r * sine);
    let reach = rim(near).max(rim(far)).max(far - middle).max(middle - near);
    (apex + to * (middle / distance))
        .extend(reach + fades)
        .to_array()
}

fn holds([x, y, z, r]: Place, [a, b, c, s]: Place) -> bool {
    Vec3::new(x, y, z).distance(Vec3::new(a, b, c)) + s <= r
}

/// The smallest sphere around two.
fn join([x, y, z, r]: Place, [a, b, c, s]: Place) -> Place {
    let (p, q) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
    let distance = p.distance(q);
    if distance + s <= r {
        return [x, y, z, r];
    }
    if distance + r <= s {
        return [a, b, c, s];
    }
    let radius = 0.5 * (distance + r + s);
    let center = p + (q - p) * ((radius - r) / distance);
    // Rounding may err, but never to the small side.
    center.extend(radius * 1.0001).to_array()
}

/// Puts those two together whose common sphere is smallest.
fn join_nearest(places: &mut Vec<Place>) {
    let pairs = (0..places.len()).flat_map(|i| (i + 1..places.len()).map(move |j| (i, j)));
    let size = |&(i, j): &(usize, usize)| join(places[i], places[j])[3];
    let Some((i, j)) = pairs.min_by(|a, b| size(a).total_cmp(&size(b))) else {
        return;
    };
    let joined = join(places[i], places[j]);
    places.swap_remove(j);
    places[i] = joined;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene() -> Aabb {
        Aabb::new(Vec3::splat(-10.0), Vec3::splat(10.0))
    }

    fn is_in(place: Place, p: Vec3) -> bool {
        let [x, y, z, r] = place;
        Vec3::new(x, y, z).distance(p) <= r * 1.0001
    }

    fn light(kind: u32) -> LightUniform {
        LightUniform {
            position: [1.0, 3.0, 0.5],
            range: 6.0,
            radiant: [1.0; 3],
            kind,
            direction: Vec3::new(0.4, -0.8, 0.1).normalize().to_array(),
            ..LightUniform::default()
        }
    }

    #[test]
    fn a_place_holds_the_box_and_its_shadow() {
        let b = Aabb::new(Vec3::new(0.2, 0.9, -0.4), Vec3::new(0.8, 1.6, 0.1));
        for kind in [0, 1] {
            let light = light(kind);
            let place = shadow_of(&light, [0.0; 2], 0.0, &b, &scene());
            for corner in b.corners() {
                assert!(is_in(place, corner));
                for step in 0..100 {
                    let (p, ends) = if kind == 0 {
                        let p = corner + Vec3::from(light.direction) * (step as f32 * 0.3);
                        (
                            p,
                            !scene().corners().is_empty() && p.abs().max_element() > 10.0,
                        )
                    } else {
                        let apex = Vec3::from(light.position);
                        let along = (corner - apex) * (1.0 + step as f32 * 0.1);
                        (apex + along, along.length() > light.range)
                    };
                    if ends {
                        break;
                    }
                    assert!(is_in(place, p), "kind {kind}, step {step}");
                }
            }
        }
    }

    #[test]
    fn what_the_light_does_not_reach_changes_nothing() {
        let far = Aabb::new(Vec3::splat(8.0), Vec3::splat(9.0));
        assert!(changed_places(&[light(1)], [0.0; 2], &[far], &scene(), |_| Some(0.0)).is_empty());
        let near = Aabb::new(Vec3::splat(1.0), Vec3::splat(1.5));
        assert_eq!(
            changed_places(&[light(1)], [0.0; 2], &[near], &scene(), |_| Some(0.0)).len(),
            1
        );
        assert!(changed_places(&[light(1)], [0.0; 2], &[near], &scene(), |_| None).is_empty());
    }

    #[test]
    fn many_places_are_put_together_and_hold_what_they_held() {
        let boxes: Vec<Aabb> = (0..60)
            .map(|i| Vec3::new(i as f32 * 0.05 - 1.0, 1.0, (i % 7) as f32 * 0.2))
            .map(|at| Aabb::new(at, at + 0.1))
            .collect();
        let places = changed_places(&[light(1), light(0)], [0.0; 2], &boxes, &scene(), |_| {
            Some(0.0)
        });
        assert!(places.len() <= MOST);
        for b in &boxes {
            assert!(
                places
                    .iter()
                    .any(|&p| b.corners().iter().all(|&c| is_in(p, c)))
            );
        }
    }
}
