// RVO2's C++ library for `gaitway bench --peers --peer ./rvo2`: a line of JSON, then "step N" and "state", until the input ends.
// In the folder src of RVO2 (https://github.com/snape/RVO2), or pyrvo/src of pyrvo's source package (PyPI). Their build would write Export.h:
//   touch Export.h
//   c++ -O3 -march=native -flto -fopenmp -DRVO_EXPORT= -o rvo2 rvo2.cc Agent.cc KdTree.cc Line.cc Obstacle.cc RVOSimulator.cc Vector2.cc
#include "RVOSimulator.h"
#include "Vector2.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

namespace {

// Where the value of a key begins.
const char *value(const std::string &json, const char *key) {
    const auto at = json.find("\"" + std::string(key) + "\":");
    if (at == std::string::npos) {
        std::fprintf(stderr, "the crowd has no %s\n", key);
        std::exit(1);
    }
    return json.c_str() + json.find(':', at) + 1;
}

float number(const std::string &json, const char *key) { return std::strtof(value(json, key), nullptr); }

// A list of pairs: [[x,y],[x,y],...].
std::vector<RVO::Vector2> pairs(const std::string &json, const char *key) {
    std::vector<RVO::Vector2> all;
    for (const char *at = value(json, key); *++at == '[';) {
        char *end = nullptr;
        const float x = std::strtof(at + 1, &end);
        const float y = std::strtof(end + 1, &end);
        all.emplace_back(x, y);
        at = end + 1; // a comma, or the end of the list
    }
    return all;
}

void print(const char *key, const std::vector<RVO::Vector2> &all) {
    std::printf("\"%s\":[", key);
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::printf("%s[%.9g,%.9g]", i == 0 ? "" : ",", static_cast<double>(all[i].x()), static_cast<double>(all[i].y()));
    }
    std::printf("]");
}

} // namespace

int main() {
    std::string line;
    std::getline(std::cin, line);
    const float side = number(line, "side");
    const float horizon = number(line, "horizon");
    const auto positions = pairs(line, "position");
    const auto velocities = pairs(line, "velocity");
    RVO::RVOSimulator sim;
    sim.setTimeStep(number(line, "time_step"));
    sim.setAgentDefaults(number(line, "neighbour_distance"), static_cast<std::size_t>(number(line, "neighbours")), horizon, horizon,
                         number(line, "radius"), number(line, "max_speed"));
    for (std::size_t i = 0; i < positions.size(); ++i) {
        sim.addAgent(positions[i]);
        sim.setAgentVelocity(i, velocities[i]);
        sim.setAgentPrefVelocity(i, velocities[i]);
    }
    std::printf("RVO2\n");
    std::fflush(stdout);

    while (std::getline(std::cin, line)) {
        if (line.rfind("step ", 0) == 0) {
            double spent = 0.0;
            for (long steps = std::atol(line.c_str() + 5); steps > 0; --steps) {
                const auto begin = std::chrono::steady_clock::now();
                sim.doStep();
                spent += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
                for (std::size_t i = 0; i < positions.size(); ++i) { // opposite sides are joined, which RVO2 cannot do: not timed
                    const RVO::Vector2 at = sim.getAgentPosition(i);
                    const RVO::Vector2 within(at.x() - side * std::floor(at.x() / side), at.y() - side * std::floor(at.y() / side));
                    sim.setAgentPosition(i, within);
                }
            }
            std::printf("%.6f\n", spent);
        } else {
            std::vector<RVO::Vector2> at, moves;
            for (std::size_t i = 0; i < positions.size(); ++i) {
                at.push_back(sim.getAgentPosition(i));
                moves.push_back(sim.getAgentVelocity(i));
            }
            std::printf("{");
            print("position", at);
            std::printf(",");
            print("velocity", moves);
            std::printf("}\n");
        }
        std::fflush(stdout);
    }
}
