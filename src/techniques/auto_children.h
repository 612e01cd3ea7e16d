// The techniques that auto has made: the one that runs, and the one before it, with all that it keeps from frame to frame.
#pragma once

#include <cstddef>
#include <memory>

#include "techniques/technique.h"

namespace lightwell {

class AutoChild {
public:
    AutoChild(std::size_t candidate, std::unique_ptr<Technique> technique) : candidate_(candidate), technique_(std::move(technique)) {}

    std::size_t candidate() const { return candidate_; }
    Technique& technique() const { return *technique_; }
    bool hasRendered() const { return hasRendered_; }

    // `inputs`: a word that says which inputs the frame brings.
    void update(Executor& executor, const LWFrame& frame, std::uint32_t inputs);
    void render(Executor& executor, const std::shared_ptr<View>& view, const LWGBuffer& gbuffer, const LWOutput& output);
    // A frame that it is not updated with.
    void miss(bool isReset);
    // Whether it has lit a view of frames that bring the same: what it then refuses is the host's mistake.
    bool knows(std::uint32_t inputs) const { return hasRendered_ && accepted_ == inputs; }

private:
    std::size_t candidate_;
    std::unique_ptr<Technique> technique_;
    std::uint32_t inputs_ = 0, accepted_ = 0;  // of the last update; of the last one that a view was lit by
    bool hasUpdated_ = false, hasRendered_ = false;
    bool hasMissed_ = false, hasMissedReset_ = false;  // since its last update
    bool isBack_ = false;  // in the frame at hand, after some that it missed
};

// At most two. A third takes the place of the one that does not run.
class AutoChildren {
public:
    AutoChild* running() const { return running_.get(); }
    AutoChild* resting() const { return resting_.get(); }

    // `child` runs, what ran rests.
    void start(std::unique_ptr<AutoChild> child);
    // The resting one, if it is that candidate: it rests no longer.
    std::unique_ptr<AutoChild> takeResting(std::size_t candidate);
    void rest(std::unique_ptr<AutoChild> child) { resting_ = std::move(child); }
    void dropResting() { resting_.reset(); }
    // The running one goes, the resting one runs, if there is one.
    void fallBack();

    void lose();
    std::uint64_t bytes() const;

private:
    std::unique_ptr<AutoChild> running_, resting_;
};

}  // namespace lightwell
