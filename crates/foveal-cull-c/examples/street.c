/* Culling from C: a street of houses, and which of the carts in it can be seen. */
#include "foveal_cull.h"

#include <stdio.h>
#include <stdlib.h>

#define HOUSES 400
/* The picture, of any size: the buffer has a quarter of it per axis, rounded up. */
#define WIDTH_PX 1366
#define HEIGHT_PX 768

static void check(FovealCullStatus status) {
    if (status != FOVEAL_CULL_OK) {
        char text[256];
        foveal_cull_last_error(text, sizeof text);
        fprintf(stderr, "%s: %s\n", foveal_cull_status_text(status), text);
        exit(1);
    }
}

int main(void) {
    /* When the level loads: one mesh, placed many times. */
    const float min[3] = {-4.0f, 0.0f, -3.0f}, max[3] = {4.0f, 6.0f, 3.0f};
    FovealCullMesh *house = NULL;
    FovealCullOccluders *occluders = NULL;
    check(foveal_cull_mesh_from_box(min, max, &house));
    check(foveal_cull_occluders_create(&occluders));
    static float carts[HOUSES][6];
    FovealCullOccluderId ids[HOUSES];
    for (int i = 0; i < HOUSES; ++i) {
        const double x = i % 20 * 11.0 - 105.0, z = -10.0 - i / 20 * 10.0;
        const double place[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, x, 0, z};
        check(foveal_cull_occluders_add(occluders, house, place, &ids[i]));
        /* A cart behind every house. */
        const float center[3] = {(float)x, 0.5f, (float)z - 4.5f};
        for (int k = 0; k < 3; ++k) {
            carts[i][k] = center[k] - 0.5f;
            carts[i][k + 3] = center[k] + 0.5f;
        }
    }
    FovealCuller *culler = NULL;
    check(foveal_culler_create_for_picture(WIDTH_PX, HEIGHT_PX, &culler));

    /* In each frame: rasterize, then test. The renderer's own matrix makes the view: at (0, 1.7, 0), along
     * -z, 90 degrees wide, reversed depth without a far plane, near plane at 0.1 m. */
    const float clip_from_world[16] = {
        1, 0, 0, 0, 0, 16.0f / 9.0f, 0, 0, 0, 0, 0, -1, 0, -1.7f * 16.0f / 9.0f, 0.1f, 0,
    };
    FovealCullEye eye;
    FovealCullView view;
    check(foveal_cull_eye_from_matrix_f32(clip_from_world, FOVEAL_CULL_DEPTH_ONE_TO_ZERO, &eye));
    check(foveal_cull_view_init(&eye, &view));
    check(foveal_cull_view_for_picture(&view, WIDTH_PX, HEIGHT_PX));
    uint8_t results[HOUSES];
    size_t visible[2] = {0, 0};
    for (int frame = 0; frame < 2; ++frame) {
        check(foveal_culler_rasterize(culler, &view, occluders, NULL, NULL));
        check(foveal_culler_test_boxes(culler, &carts[0][0], HOUSES, NULL, results));
        for (int i = 0; i < HOUSES; ++i) {
            visible[frame] += results[i] == FOVEAL_CULL_VISIBLE;
        }
        /* For the second frame the first row of houses is pulled down. */
        for (int i = 0; frame == 0 && i < 20; ++i) {
            check(foveal_cull_occluders_remove(occluders, ids[i]));
        }
    }
    FovealCullStats stats;
    check(foveal_culler_stats(culler, &stats));
    printf("%d carts, %zu visible; %zu without the first row of %d + 20 houses\n", HOUSES, visible[0], visible[1],
           (int)stats.occluder_models);

    foveal_culler_destroy(culler);
    foveal_cull_occluders_destroy(occluders);
    foveal_cull_mesh_destroy(house);
    return visible[0] < visible[1] && visible[1] < HOUSES ? 0 : 1;
}
