// Culling from C++ with the program's own jobs: a door that opens, carts that drive, two eyes, tests on many
// threads.
#include "foveal_cull.hpp"

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <future>
#include <mutex>
#include <thread>

namespace cull = foveal::cull;

/// A job system as engines have them: threads that wait, and tasks that whoever is free takes.
class Workers {
public:
    explicit Workers(unsigned count) {
        for (unsigned i = 0; i < count; ++i) {
            threads_.emplace_back([this] { work(); });
        }
    }
    ~Workers() {
        {
            std::lock_guard<std::mutex> lock(mutex_);
            stop_ = true;
        }
        changed_.notify_all();
        for (auto &thread : threads_) {
            thread.join();
        }
    }
    void run(std::uint32_t tasks, const cull::JobSystem::Task &task) {
        std::unique_lock<std::mutex> lock(mutex_);
        task_ = &task;
        tasks_ = tasks;
        next_ = done_ = 0;
        changed_.notify_all();
        changed_.wait(lock, [&] { return done_ == tasks; });
        task_ = nullptr;
    }

private:
    void work() {
        std::unique_lock<std::mutex> lock(mutex_);
        for (;;) {
            changed_.wait(lock, [&] { return stop_ || (task_ && next_ < tasks_); });
            if (stop_) {
                return;
            }
            const auto task = task_;
            const auto index = next_++;
            lock.unlock();
            (*task)(index);
            lock.lock();
            ++done_;
            changed_.notify_all();
        }
    }
    std::vector<std::thread> threads_;
    std::mutex mutex_;
    std::condition_variable changed_;
    const cull::JobSystem::Task *task_ = nullptr;
    std::uint32_t tasks_ = 0, next_ = 0, done_ = 0;
    bool stop_ = false;
};

/// The results of carts in the order of their ids.
static std::vector<cull::Visibility> carts_seen(const cull::Culler &culler, const cull::Occludees &carts,
                                                const std::vector<cull::OccludeeId> &ids) {
    const auto results = culler.test(carts);
    std::vector<cull::Visibility> of_ids;
    for (const auto index : carts.indices(ids)) {
        of_ids.push_back(results[index]);
    }
    return of_ids;
}

int main() try {
    // A wall with a doorway 2 m wide, and a door in it. Indices of 16 bits.
    const float wall[] = {-20, -3, -5, -1, -3, -5, -1, 4, -5, -20, 4, -5, 1, -3, -5, 20, -3, -5, 20, 4, -5, 1, 4, -5};
    const std::uint16_t indices[] = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
    cull::Occluders occluders;
    // Baked once: a game keeps the bytes in a file, and reads that when the level loads.
    cull::MeshOptions both_sides;
    both_sides.two_sided = true;
    const auto file = cull::Mesh(wall, 8, 3 * sizeof(float), indices, 12, both_sides).to_bytes();
    occluders.add(cull::Mesh::from_bytes(file));
    const cull::Mesh leaf = cull::Mesh::box({{-1.1f, -3, -0.1f}, {1.1f, 4, 0.1f}});
    const auto at = [](double x) { return cull::Affine{1, 0, 0, 0, 1, 0, 0, 0, 1, x, 0, -5}; };
    const cull::OccluderId door = occluders.add(leaf, at(0));

    std::vector<cull::Box> boxes;
    for (int i = 0; i < 1000; ++i) {
        const float x = static_cast<float>(i % 40) - 20, z = -8 - static_cast<float>(i / 40);
        boxes.push_back({{x, 0, z}, {x + 0.5f, 0.5f, z + 0.5f}});
    }
    const cull::Tree tree(boxes);
    const auto eye = [](double x) {
        return cull::look_at({x, 0.2, 0}, {x, 0.2, -1}, {0, 1, 0}, 0.9, 1.5, 0.1);
    };
    const cull::View view = cull::View(eye(-0.032), eye(0.032), 0.005).for_picture(1918, 1279);

    Workers workers(3);
    cull::JobSystem jobs(3, [&](std::uint32_t tasks, const cull::JobSystem::Task &task) { workers.run(tasks, task); });
    cull::Threads threads(2);
    cull::Culler culler = cull::Culler::for_picture(1918, 1279);
    std::size_t seen[2] = {0, 0};
    for (int frame = 0; frame < 2; ++frame) {
        culler.rasterize(view, occluders, jobs);
        const auto depth = culler.depth();
        culler.rasterize(view, occluders, threads);
        if (depth != culler.depth()) {
            throw std::logic_error("the depth depends on the threads");
        }
        const auto by_tree = culler.test(tree);
        // Tests take a const culler: as many threads as one likes.
        std::vector<cull::Visibility> results(boxes.size());
        workers.run(4, [&](std::uint32_t i) { culler.test(&boxes[250 * i], 250, &results[250 * i]); });
        for (std::size_t i = 0; i < boxes.size(); ++i) {
            seen[frame] += by_tree[i] == cull::Visibility::visible;
            if (by_tree[i] == cull::Visibility::visible && results[i] != by_tree[i]) {
                throw std::logic_error("a tree sees less than it hides");
            }
        }
        occluders.move(door, at(2.3));
    }
    std::printf("%zu boxes: %zu visible through the closed door, %zu through the open one\n", boxes.size(), seen[0],
                seen[1]);

    // Carts drive past the open door. Their hierarchy follows, and is built again by another thread meanwhile.
    const auto cart = [](int i, int frame) {
        const float x = static_cast<float>(i % 60) - 30 + 0.3f * static_cast<float>(frame * (i % 7));
        const float z = -8 - static_cast<float>(i / 60);
        return cull::Box{{x, 0, z}, {x + 0.5f, 0.5f, z + 0.5f}};
    };
    std::vector<cull::Box> places;
    for (int i = 0; i < 2400; ++i) {
        places.push_back(cart(i, 0));
    }
    cull::Occludees carts;
    std::vector<cull::OccludeeId> ids = carts.insert_all(places);
    culler.rasterize(view, occluders, jobs);
    cull::Rebuild rebuild = carts.snapshot();
    // Whatever is thrown below, the future waits for the builder before the rebuild is gone.
    std::future<void> builder = std::async(std::launch::async, [&] { rebuild.build(); });
    std::size_t passed[2] = {0, 0}, hidden = 0, more = 0;
    for (int frame = 0; frame < 8; ++frame) {
        if (frame == 4) {
            builder.get();
            if (!rebuild.built()) {
                throw std::logic_error("what was built is not");
            }
            carts.adopt(rebuild);
            // It stays until the builder, which could be another thread's to wait for, has returned.
            if (!rebuild.built()) {
                throw std::logic_error("what was adopted is gone");
            }
        }
        for (std::size_t i = 0; i < ids.size(); ++i) {
            places[i] = cart(static_cast<int>(i), frame);
        }
        carts.move_all(ids, places);
        carts.refit();
        const auto results = carts_seen(culler, carts, ids);
        const auto one_by_one = culler.test(places);
        for (std::size_t i = 0; i < ids.size(); ++i) {
            // They differ only where a group is hidden as a whole.
            if (results[i] != cull::Visibility::occluded && results[i] != one_by_one[i]) {
                throw std::logic_error("a set finds other than a list");
            }
            passed[frame / 4] += results[i] == cull::Visibility::visible;
            hidden += results[i] != cull::Visibility::visible;
            more += results[i] != cull::Visibility::visible && one_by_one[i] == cull::Visibility::visible;
        }
    }
    if (hidden < ids.size() || 100 * more > hidden) {
        throw std::logic_error("a set hides too little, or much that a list sees");
    }
    const cull::Box last = carts.bounds(ids.back());
    const bool where = last.min[0] == places.back().min[0] && last.max[2] == places.back().max[2];
    carts.remove(ids.back());
    const cull::OccludeeId next = carts.insert(last);
    const bool known = carts.contains(next) && !carts.contains(ids.back());
    if (!where || !known || carts.index(next) >= carts.result_count() || carts.count() != ids.size()) {
        throw std::logic_error("carts are not where they were put");
    }
    std::printf("%zu carts, %zu and %zu times seen through the door, %zu times not (%zu only by their group)\n",
                carts.count(), passed[0], passed[1], hidden, more);

    // Errors say what is wrong.
    occluders.remove(door);
    try {
        occluders.move(door, at(0));
        return 1;
    } catch (const cull::Error &error) {
        std::printf("moving a door that is gone: %s\n", error.what());
        if (error.status() != FOVEAL_CULL_UNKNOWN_OCCLUDER) {
            return 1;
        }
    }
    try {
        carts.move_all(ids, places);
        return 1;
    } catch (const cull::Error &error) {
        std::printf("moving a cart that is gone: %s\n", error.what());
        if (error.status() != FOVEAL_CULL_UNKNOWN_OCCLUDEE) {
            return 1;
        }
    }
    return seen[0] < seen[1] && seen[1] < boxes.size() ? 0 : 1;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
