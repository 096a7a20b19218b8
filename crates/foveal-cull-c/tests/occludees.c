/* Occludees that come, move and go, from C: what the set says is what a list says, whichever thread builds
 * the hierarchy. Ends with 0 if all is well. */
#include "foveal_cull.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CARTS 3000
#define FRAMES 12

static void expect(FovealCullStatus expected, FovealCullStatus status) {
    if (status != expected) {
        char text[256];
        foveal_cull_last_error(text, sizeof text);
        fprintf(stderr, "%d instead of %d: %s\n", (int)status, (int)expected, text);
        exit(1);
    }
}

static void check(int holds, const char *text) {
    if (!holds) {
        fprintf(stderr, "not so: %s\n", text);
        exit(1);
    }
}

static void *build(void *rebuild) {
    expect(FOVEAL_CULL_OK, foveal_cull_rebuild_build((FovealCullRebuild *)rebuild));
    return NULL;
}

/* Where cart i is in a frame: it drives along x, behind a row of houses. */
static void place(int i, int frame, float *bounds) {
    const float lane = (float)(i / 60), x = (float)(i % 60) * 3.0f - 90.0f + (float)(frame * (i % 5));
    const float min[3] = {x, 0.0f, -14.0f - 3.0f * lane};
    for (int k = 0; k < 3; ++k) {
        bounds[k] = min[k];
        bounds[k + 3] = min[k] + 1.0f;
    }
}

static float boxes[CARTS][6];
static FovealCullOccludeeId ids[CARTS];
static uint32_t indices[CARTS];
static uint8_t of_list[CARTS];

int main(void) {
    FovealCullMesh *house = NULL;
    FovealCullOccluders *occluders = NULL;
    FovealCullOccluderId occluder;
    const float min[3] = {-4.0f, 0.0f, -1.0f}, max[3] = {4.0f, 5.0f, 1.0f};
    expect(FOVEAL_CULL_OK, foveal_cull_mesh_from_box(min, max, &house));
    expect(FOVEAL_CULL_OK, foveal_cull_occluders_create(&occluders));
    for (int i = 0; i < 12; ++i) {
        const double at[12] = {1, 0, 0, 0, 1, 0, 0, 0, 1, i * 10.0 - 55.0, 0, -10};
        expect(FOVEAL_CULL_OK, foveal_cull_occluders_add(occluders, house, at, &occluder));
    }
    const double position[3] = {0, 1.7, 0}, target[3] = {0, 1.7, -1}, up[3] = {0, 1, 0};
    FovealCullEye eye;
    FovealCullView view;
    FovealCuller *culler = NULL;
    expect(FOVEAL_CULL_OK, foveal_cull_eye_look_at(position, target, up, 1.0, 1.6, 0.1, &eye));
    expect(FOVEAL_CULL_OK, foveal_cull_view_init(&eye, &view));
    expect(FOVEAL_CULL_OK, foveal_culler_create(320, 200, &culler));
    expect(FOVEAL_CULL_OK, foveal_culler_rasterize(culler, &view, occluders, NULL, NULL));

    FovealCullOccludees *carts = NULL, *other = NULL;
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_create(NULL, &carts));
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_create(position, &other));
    for (int i = 0; i < CARTS; ++i) {
        place(i, 0, boxes[i]);
    }
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_insert(carts, &boxes[0][0], CARTS, ids));
    uint32_t wants = 0, built = 9;
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_wants_rebuild(carts, &wants));
    check(wants == 1, "all are new");

    /* Built on another thread while frames go on. */
    FovealCullRebuild *rebuild = NULL;
    pthread_t builder;
    size_t hidden = 0, more = 0, count = 0;
    for (int frame = 0; frame < FRAMES; ++frame) {
        if (frame == 2) {
            expect(FOVEAL_CULL_OK, foveal_cull_occludees_snapshot(carts, &rebuild));
            expect(FOVEAL_CULL_BAD_ARGUMENT, foveal_cull_occludees_adopt(carts, rebuild));
            expect(FOVEAL_CULL_OK, foveal_cull_rebuild_is_built(rebuild, &built));
            check(built == 0, "nobody has built it");
            check(pthread_create(&builder, NULL, build, rebuild) == 0, "a thread");
        }
        for (int i = 0; i < CARTS; ++i) {
            place(i, frame, boxes[i]);
        }
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_move(carts, ids, &boxes[0][0], CARTS));
        /* One comes and one goes, in whose place it is. */
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_remove(carts, &ids[frame], 1));
        const FovealCullOccludeeId gone = ids[frame];
        expect(FOVEAL_CULL_UNKNOWN_OCCLUDEE, foveal_cull_occludees_move(carts, ids, &boxes[0][0], CARTS));
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_insert(carts, boxes[frame], 1, &ids[frame]));
        uint32_t contains[2] = {9, 9};
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_contains(carts, gone, &contains[0]));
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_contains(carts, ids[frame], &contains[1]));
        check(contains[0] == 0 && contains[1] == 1, "an id names one occludee for ever");
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_refit(carts));
        if (frame == 6) {
            do {
                expect(FOVEAL_CULL_OK, foveal_cull_rebuild_is_built(rebuild, &built));
            } while (built == 0);
            check(pthread_join(builder, NULL) == 0, "the thread ends");
            expect(FOVEAL_CULL_OTHER_SET, foveal_cull_occludees_adopt(other, rebuild));
            expect(FOVEAL_CULL_OK, foveal_cull_occludees_adopt(carts, rebuild));
            expect(FOVEAL_CULL_BAD_ARGUMENT, foveal_cull_occludees_adopt(carts, rebuild));
            expect(FOVEAL_CULL_BAD_ARGUMENT, foveal_cull_rebuild_build(rebuild));
            foveal_cull_rebuild_destroy(rebuild);
            expect(FOVEAL_CULL_OK, foveal_cull_occludees_wants_rebuild(carts, &wants));
            check(wants == 0, "the hierarchy is new");
        }
        if (frame == 9) {
            expect(FOVEAL_CULL_OK, foveal_cull_occludees_rebuild(carts));
        }
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_result_count(carts, &count));
        check(count == CARTS, "places are used again");
        uint8_t *results = malloc(count);
        check(results != NULL, "memory");
        expect(FOVEAL_CULL_WRONG_LENGTH, foveal_culler_test_occludees(culler, carts, results, count - 1));
        expect(FOVEAL_CULL_OK, foveal_culler_test_occludees(culler, carts, results, count));
        expect(FOVEAL_CULL_OK, foveal_cull_occludees_indices(carts, ids, CARTS, indices));
        expect(FOVEAL_CULL_OK, foveal_culler_test_boxes(culler, &boxes[0][0], CARTS, NULL, of_list));
        for (int i = 0; i < CARTS; ++i) {
            const uint8_t result = results[indices[i]];
            check(result != FOVEAL_CULL_VISIBLE || of_list[i] == FOVEAL_CULL_VISIBLE, "a list hides less");
            hidden += result == FOVEAL_CULL_OCCLUDED;
            more += result != FOVEAL_CULL_VISIBLE && of_list[i] == FOVEAL_CULL_VISIBLE;
        }
        free(results);
    }
    float bounds[6];
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_bounds(carts, ids[7], bounds));
    check(memcmp(bounds, boxes[7], sizeof bounds) == 0, "the box is where it was put");
    expect(FOVEAL_CULL_OTHER_SET, foveal_cull_occludees_bounds(other, ids[7], bounds));
    expect(FOVEAL_CULL_OTHER_SET, foveal_cull_occludees_remove(other, ids, CARTS));
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_remove(carts, ids, CARTS));
    expect(FOVEAL_CULL_OK, foveal_cull_occludees_count(carts, &count));
    check(count == 0, "all are gone");
    printf("%zu of %d carts hidden, %zu of them by their group\n", hidden, CARTS * FRAMES, more);

    foveal_cull_occludees_destroy(other);
    foveal_cull_occludees_destroy(carts);
    foveal_culler_destroy(culler);
    foveal_cull_occluders_destroy(occluders);
    foveal_cull_mesh_destroy(house);
    return hidden > CARTS && more * 100 < hidden ? 0 : 1;
}
