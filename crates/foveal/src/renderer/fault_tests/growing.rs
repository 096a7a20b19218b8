//! Tables that outgrow their room while memory is out.

use super::*;

#[test]
fn a_pose_whose_lights_outgrow_their_table_can_fail_anywhere() {
    let mut pose = moved();
    generate::add_point_lights(&mut pose, 300, 2);
    survives_pose(&pose);
}

/// The larger scene's instances have no table then, and the old ones are gone.
#[test]
fn a_smaller_scene_can_be_set_after_one_whose_instances_found_no_memory() {
    let gpu = host_gpu();
    let settings = small(48, 32);
    let mut larger = scene();
    let one = larger.instances[0];
    larger.instances.resize(300, one);
    let smaller = moved();
    let mut fresh = block_on(ready(&gpu, &settings)).expect("nothing fails");
    let calls = calls(&gpu, || {
        block_on(fresh.set_scene(&larger)).expect("nothing fails");
    });
    block_on(fresh.set_scene(&smaller)).expect("nothing fails");
    block_on(draw(&mut fresh)).expect("drawn");
    let mut torn = 0;
    for place in 0..calls {
        let mut renderer = block_on(ready(&gpu, &settings)).expect("nothing fails");
        gpu.device.faults.arm(place, Fault::OutOfMemory);
        block_on(renderer.set_scene(&larger)).expect_err("memory is out");
        if !renderer.is_torn {
            continue;
        }
        torn += 1;
        // Memory for mending is out, too.
        gpu.device.faults.arm(0, Fault::OutOfMemory);
        block_on(renderer.set_scene(&smaller)).expect("the smaller scene");
        assert!(gpu.device.faults.disarm() && renderer.is_torn);
        block_on(draw(&mut renderer)).expect("memory is there again");
        assert!(picture(&renderer) == picture(&fresh), "call {place}");
    }
    assert!(torn >= 2, "{torn} of {calls}");
}
