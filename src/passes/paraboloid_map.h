// One paraboloid map per cluster of VPLs: what the cluster's medoid sees, triangles drawn exactly.
#pragma once

#include <cstdint>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "compute/report.h"
#include "inputs/geometry_input.h"
#include "shared/cluster_types.h"
#include "shared/paraboloid_types.h"

namespace lightwell {

// The maps as passes draw into them and fill them.
struct MapTexels {
    const Buffer& frames;   // lw_paraboloid per map
    const Buffer& states;   // per map, see paraboloid_map_types.h
    const Buffer& records;  // two words per texel, see paraboloid_types.h
    const Buffer& albedo;   // a word per texel
    std::uint32_t size, mapCount;
};

class ParaboloidMap {
public:
    // `size`: texels a side of every map; 64 .. 512, a multiple of 16.
    ParaboloidMap(Device& device, std::uint32_t size);

    // Records passes "paraboloid_map.*". `clusters`: lw_cluster each, `clusterCount` of them. A map is redrawn
    // only when its cluster's medoid or normal moved or the geometry changed in its sight; that is found out on the device.
    void record(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount,
                const GeometryInput& geometry);
    // For another pass to draw into: places the maps, and empties those that are stale. `diagonal`: of the geometry, a
    // float on the device, m; `revision`: differs whenever the geometry does. Once all is recorded: noteDrawn().
    void recordPlaces(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount, const Buffer& diagonal,
                      std::uint64_t revision);
    void noteDrawn(std::uint64_t revision);
    // Pass "paraboloid_map.marks", after all that draws: what strict look-ups ask for (LW_PARABOLOID_DOUBTFUL), of the maps drawn anew.
    void recordMarks(Executor& executor);
    // Of a frame that keeps the last one's maps as they are, instead of all that: counts none.
    void recordKept(Executor& executor);
    MapTexels texels() const { return {frames_, state_, records_, albedo_, size_, mapCount_}; }
    void redrawAll() { drawnCount_ = 0; }  // in the next record(), whatever moved

    std::uint32_t size() const { return size_; }
    std::uint32_t mapCount() const { return mapCount_; }
    const Buffer& frames() const { return frames_; }    // lw_paraboloid per map
    const Buffer& records() const { return records_; }  // two words per texel, see paraboloid_types.h
    const Buffer& albedo() const { return albedo_; }    // a word per texel, see pack_albedo in paraboloid.h
    // The first record of map k.
    std::int32_t firstRecord(std::uint32_t k) const { return std::int32_t(k * size_ * size_); }

    // Planes without memory: distance (m), normal in the world, albedo; 0 where a texel met nothing; maps one below
    // the other.
    Planes debugShape() const;
    void recordPlanes(Executor& executor, const Planes& planes);  // fills them

    void report(Report& report) const;  // maps_redrawn
    std::uint64_t bytes() const;
    static std::uint64_t estimateBytes(std::uint32_t size, std::uint32_t clusterCount);
    // Where other passes draw into the maps.
    static std::uint64_t estimatePlacesBytes(std::uint32_t size, std::uint32_t clusterCount);

private:
    void reserve(std::uint32_t clusterCount);
    void place(Executor& executor, const Buffer& clusters, std::uint32_t clusterCount, const Buffer& diagonal, bool force);
    void notice(Executor& executor, const Buffer& changes);
    Range grid() const;  // of blocks of texels

    Device& device_;
    std::uint32_t size_;
    Kernel &place_, &clear_, &trace_, &notice_, &marks_, &planes_;
    Buffer frames_, state_, records_, albedo_, counters_, diagonal_;
    std::uint32_t mapCount_ = 0;
    std::uint32_t drawnCount_ = 0;  // maps that hold what `drawnRevision_` showed
    std::uint64_t drawnRevision_ = 0;
};

}  // namespace lightwell
