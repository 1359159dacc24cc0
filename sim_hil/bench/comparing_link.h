/// Two controllers driven by the same stimuli, their replies compared word by word.
#ifndef QUIESCE_COMPARING_LINK_H
#define QUIESCE_COMPARING_LINK_H

#include <string>

#include "controller_link.h"

namespace quiesce {

/// Where two replies first differed.
struct FirstMismatch {
    std::uint64_t run; ///< number of the start, from 0
    std::int64_t tick; ///< within the run, from 0
    std::string field; ///< name of the word
};

/// Whose command the plant gets.
enum class Answer {
    Reference, ///< the plant never sees the checked target
    Checked,   ///< words that the checked target has not sent in a tick are the reference's
};

/// Compares, in each tick, the words that the checked target has sent in it.
class ComparingLink final : public ControllerLink {
  public:
    ComparingLink(ControllerLink &reference, ControllerLink &checked,
                  Answer answer = Answer::Reference)
        : reference_(reference), checked_(checked), answer_(answer) {}

    std::string target() const override { return checked_.target(); }

    /// Throws InputError when one accepts what the other refuses.
    StartAnswer start(const quiesce_board_t *board, const quiesce_params_t &params,
                      const Tables &tables) override;
    void exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) override;
    std::optional<InstructionCounts> finish() override { return checked_.finish(); }

    /// Words that differed, over all runs.
    std::uint64_t mismatches() const { return mismatches_; }
    std::uint64_t compared_words() const { return compared_words_; }
    const std::optional<FirstMismatch> &first_mismatch() const { return first_mismatch_; }

  private:
    void compare(const lockstep_reply_t &expected, const lockstep_reply_t &actual,
                 const ReplyWords &received);

    ControllerLink &reference_;
    ControllerLink &checked_;
    Answer answer_;
    std::uint64_t runs_ = 0;
    std::int64_t tick_ = 0;
    std::uint64_t mismatches_ = 0;
    std::uint64_t compared_words_ = 0;
    std::optional<FirstMismatch> first_mismatch_;
};

} // namespace quiesce

#endif
