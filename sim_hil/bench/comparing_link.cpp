#include "comparing_link.h"

#include <cstring>

#include "input_error.h"
#include "reply_fields.h"
#include "start.h"

namespace quiesce {

namespace {

void copy_words(const lockstep_reply_t &from, const ReplyWords &words, lockstep_reply_t &to) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words.test(i)) {
            std::memcpy(reinterpret_cast<unsigned char *>(&to) + sizeof(std::uint32_t) * i,
                        reinterpret_cast<const unsigned char *>(&from) + sizeof(std::uint32_t) * i,
                        sizeof(std::uint32_t));
        }
    }
}

} // namespace

StartAnswer ComparingLink::start(const quiesce_board_t *board, const quiesce_params_t &params,
                                 const Tables &tables) {
    const StartAnswer answer = reference_.start(board, params, tables);
    const StartAnswer other = checked_.start(board, params, tables);
    if (answer && other.param) {
        refuse_start(checked_, other, board, params, tables);
    }
    if (other.is_accepted != answer.is_accepted || other.table.verdict != answer.table.verdict ||
        other.table.table != answer.table.table) {
        throw InputError("targets " + reference_.target() + " and " + checked_.target() +
                         " disagree on whether parameters, board and tables are allowed; rebuild "
                         "both, for as many sensors and dampers");
    }
    ++runs_;
    tick_ = 0;
    return answer;
}

void ComparingLink::exchange(const lockstep_stimulus_t &stimulus, lockstep_reply_t &reply) {
    lockstep_reply_t checked;
    reference_.exchange(stimulus, reply);
    checked_.exchange(stimulus, checked);
    const ReplyWords received = checked_.received();
    compared_words_ += received.count();
    if (std::memcmp(&reply, &checked, sizeof reply) != 0) {
        compare(reply, checked, received);
        if (answer_ == Answer::Checked) {
            copy_words(checked, received, reply);
        }
    }
    ++tick_;
}

void ComparingLink::compare(const lockstep_reply_t &expected, const lockstep_reply_t &actual,
                            const ReplyWords &received) {
    const std::vector<WordField> &fields = reply_fields();
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (received.test(i) && word_of(expected, i) != word_of(actual, i)) {
            ++mismatches_;
            if (!first_mismatch_) {
                first_mismatch_ = FirstMismatch{runs_ - 1, tick_, fields[i].name};
            }
        }
    }
}

} // namespace quiesce
