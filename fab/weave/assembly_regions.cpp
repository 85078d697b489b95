#include "fab/weave/assembly_regions.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>

namespace leafcutter::fab {

namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Groups {
public:
    explicit Groups(std::size_t size) : parent_(size) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int of(int member) {
        while (parent_[at(member)] != member) {
            member = parent_[at(member)] = parent_[at(parent_[at(member)])];
        }
        return member;
    }
    void join(int one, int other) {
        const auto [low, high] = std::minmax({of(one), of(other)});
        parent_[at(high)] = low;
    }

private:
    std::vector<int> parent_;
};

// Regions: cylinders that strips run through belong together. Neighbours follow each other.
class RegionFinder {
public:
    RegionFinder(const geometry::QuadMesh& mesh, std::span<const Strip> strips)
        : mesh_(mesh), groups_(cylinder_count(mesh)) {
        for (const Strip& strip : strips) {
            for (const int quad : strip.quads) {
                groups_.join(cylinder_of(strip.quads.front()), cylinder_of(quad));
            }
        }
    }

    std::vector<AssemblyRegion> find(std::span<const Part> parts) {
        std::map<int, AssemblyRegion> by_group;
        for (int cylinder = 0; cylinder < static_cast<int>(cylinder_count(mesh_)); ++cylinder) {
            by_group[groups_.of(cylinder)].cylinders.push_back(cylinder);
        }
        std::vector<char> has_cells(cylinder_count(mesh_), 0);
        for (const geometry::QuadAddress& address : mesh_.addresses) {
            has_cells[at(groups_.of(address.cylinder))] = 1;
        }
        for (std::size_t part = 0; part < parts.size(); ++part) {
            for (const int cylinder : parts[part].cylinders) {
                by_group[groups_.of(cylinder)].part = static_cast<int>(part);
            }
        }
        find_neighbours();
        std::vector<AssemblyRegion> regions;
        std::map<int, char> done;
        for (const auto& [group, region] : by_group) {
            if (has_cells[at(group)] != 0) {
                walk(group, by_group, done, regions);
            }
        }
        return regions;
    }

private:
    static std::size_t cylinder_count(const geometry::QuadMesh& mesh) {
        std::size_t count = mesh.grids.size();
        for (const geometry::QuadAddress& address : mesh.addresses) {
            count = std::max(count, at(address.cylinder) + 1);
        }
        return count;
    }

    int cylinder_of(int quad) const { return mesh_.addresses[at(quad)].cylinder; }

    // Regions that share vertices.
    void find_neighbours() {
        std::vector<std::vector<int>> at_vertex(mesh_.vertices.size());
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            const int group = groups_.of(mesh_.addresses[quad].cylinder);
            for (const int vertex : mesh_.quads[quad]) {
                auto& there = at_vertex[at(vertex)];
                if (std::find(there.begin(), there.end(), group) == there.end()) {
                    there.push_back(group);
                }
            }
        }
        for (const std::vector<int>& there : at_vertex) {
            for (const int one : there) {
                for (const int other : there) {
                    if (one != other) {
                        ++neighbours_[one][other];
                    }
                }
            }
        }
    }

    // Depth first, to the neighbour with the longest common border.
    void walk(int first,
              std::map<int, AssemblyRegion>& by_group,
              std::map<int, char>& done,
              std::vector<AssemblyRegion>& regions) {
        std::vector<int> path;
        if (std::exchange(done[first], 1) == 0) {
            regions.push_back(by_group[first]);
            path.push_back(first);
        }
        while (!path.empty()) {
            int next = -1;
            int border = 0;
            for (const auto& [other, shared] : neighbours_[path.back()]) {
                if (done[other] == 0 && shared > border) {
                    next = other;
                    border = shared;
                }
            }
            if (next < 0) {
                path.pop_back();
                continue;
            }
            done[next] = 1;
            regions.push_back(by_group[next]);
            path.push_back(next);
        }
    }

    const geometry::QuadMesh& mesh_;
    Groups groups_;
    std::map<int, std::map<int, int>> neighbours_;
};

}  // namespace

std::vector<AssemblyRegion> assembly_regions(const geometry::QuadMesh& mesh,
                                             std::span<const Strip> strips,
                                             std::span<const Part> parts) {
    return RegionFinder(mesh, strips).find(parts);
}

std::vector<std::vector<int>> members_of(std::span<const AssemblyRegion> regions,
                                         const geometry::QuadMesh& mesh,
                                         std::span<const Strip> strips) {
    std::vector<std::size_t> region_of;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        for (const int cylinder : regions[i].cylinders) {
            region_of.resize(std::max(region_of.size(), at(cylinder) + 1));
            region_of[at(cylinder)] = i;
        }
    }
    std::vector<std::vector<int>> members(regions.size());
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const int cylinder = mesh.addresses[at(strips[i].quads.front())].cylinder;
        members[region_of[at(cylinder)]].push_back(static_cast<int>(i));
    }
    return members;
}

}  // namespace leafcutter::fab
