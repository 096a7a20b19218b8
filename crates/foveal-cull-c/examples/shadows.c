/* Shadow casters from C: which crates a lamp's six shadow maps need, when the camera sees half of a hall. */
#include "foveal_cull.h"

#include <stdio.h>
#include <stdlib.h>

#define CRATES 600
#define SHADOW_MAP_PX 512

static void check(FovealCullStatus status) {
    if (status != FOVEAL_CULL_OK) {
        char text[256];
        foveal_cull_last_error(text, sizeof text);
        fprintf(stderr, "%s: %s\n", foveal_cull_status_text(status), text);
        exit(1);
    }
}

static void look(const double *from, const double *towards, const double *up, double fov_y_rad, double aspect,
                 FovealCullView *view) {
    FovealCullEye eye;
    const double target[3] = {from[0] + towards[0], from[1] + towards[1], from[2] + towards[2]};
    check(foveal_cull_eye_look_at(from, target, up, fov_y_rad, aspect, 0.05, &eye));
    check(foveal_cull_view_init(&eye, view));
}

int main(void) {
    /* A hall with a wall across it. Crates stand on the floor on both sides, and a lamp hangs behind the wall. */
    const float wall_min[3] = {-20.0f, 0.0f, -10.2f}, wall_max[3] = {4.0f, 8.0f, -10.0f};
    FovealCullMesh *wall = NULL;
    FovealCullOccluders *occluders = NULL;
    FovealCullOccluderId id;
    check(foveal_cull_mesh_from_box(wall_min, wall_max, &wall));
    check(foveal_cull_occluders_create(&occluders));
    check(foveal_cull_occluders_add(occluders, wall, NULL, &id));
    static float boxes[CRATES][6];
    for (int i = 0; i < CRATES; ++i) {
        const float min[3] = {i % 30 * 1.2f - 18.0f, 0.0f, -2.0f - 1.2f * (i / 30)};
        for (int k = 0; k < 3; ++k) {
            boxes[i][k] = min[k];
            boxes[i][k + 3] = min[k] + 0.6f;
        }
    }

    /* What the camera sees receives shadows. */
    const double camera_at[3] = {0, 1.7, 4}, ahead[3] = {0, 0, -1}, up[3] = {0, 1, 0};
    FovealCullView camera;
    FovealCuller *culler = NULL, *map = NULL;
    static uint8_t seen[CRATES], casters[CRATES];
    look(camera_at, ahead, up, 1.0, 1.6, &camera);
    check(foveal_culler_create_for_picture(1920, 1200, &culler));
    check(foveal_cull_view_for_picture(&camera, 1920, 1200));
    check(foveal_culler_rasterize(culler, &camera, occluders, NULL, NULL));
    check(foveal_culler_test_boxes(culler, &boxes[0][0], CRATES, NULL, seen));

    /* The sides of the lamp's cube, with one mask and one culler for all of them. The culler's samples are the
     * map's texels. The maps must draw the front faces of the wall, with which it hides crates from the lamp. */
    static const double sides[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const double lamp_at[3] = {2, 3, -12}, half_pi = 1.5707963267948966;
    FovealCullReceiverMask *mask = NULL;
    int drawn = 0;
    size_t in_maps = 0, cast = 0;
    check(foveal_culler_create_for_picture(SHADOW_MAP_PX, SHADOW_MAP_PX, &map));
    for (int side = 0; side < 6; ++side) {
        const double around[3] = {0, side == 2 || side == 3 ? 0 : 1, side == 2 || side == 3 ? 1 : 0};
        FovealCullView light;
        look(lamp_at, sides[side], around, half_pi, 1.0, &light);
        if (mask == NULL) {
            check(foveal_cull_receiver_mask_create(&light, SHADOW_MAP_PX, &mask));
            /* A filter of 3x3 texels, after moving places by 2 cm along their normals. */
            check(foveal_cull_receiver_mask_set_reach(mask, 2.0, 0.02));
        } else {
            check(foveal_cull_receiver_mask_reset(mask, &light, SHADOW_MAP_PX));
        }
        check(foveal_cull_receiver_mask_receive(mask, &boxes[0][0], CRATES, NULL, seen));
        uint32_t empty = 0;
        check(foveal_cull_receiver_mask_is_empty(mask, &empty));
        if (empty) {
            continue;
        }
        ++drawn;
        /* Casters that others hide from the lamp, and then those whose shadows nobody sees. The mask has the map's
         * own view, the culler the view that ends with whole pixels of its buffer. */
        check(foveal_cull_view_for_picture(&light, SHADOW_MAP_PX, SHADOW_MAP_PX));
        check(foveal_culler_rasterize(map, &light, occluders, NULL, NULL));
        check(foveal_culler_test_boxes(map, &boxes[0][0], CRATES, NULL, casters));
        for (int i = 0; i < CRATES; ++i) {
            in_maps += casters[i] != FOVEAL_CULL_OUTSIDE;
        }
        check(foveal_cull_receiver_mask_cull(mask, &boxes[0][0], CRATES, NULL, casters));
        for (int i = 0; i < CRATES; ++i) {
            cast += casters[i] == FOVEAL_CULL_VISIBLE;
        }
    }
    size_t receivers = 0;
    for (int i = 0; i < CRATES; ++i) {
        receivers += seen[i] == FOVEAL_CULL_VISIBLE;
    }
    printf("%zu of %d crates are seen; %d of 6 shadow maps are drawn, with %zu of %zu casters\n", receivers, CRATES,
           drawn, cast, in_maps);

    foveal_cull_receiver_mask_destroy(mask);
    foveal_culler_destroy(map);
    foveal_culler_destroy(culler);
    foveal_cull_occluders_destroy(occluders);
    foveal_cull_mesh_destroy(wall);
    return drawn > 0 && drawn < 6 && cast > 0 && cast < in_maps ? 0 : 1;
}
