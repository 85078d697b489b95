#include "fab/weave/pattern.h"

namespace leafcutter::fab {

PatternMatrix pattern_matrix(const WeaveParams& params) {
    switch (params.pattern) {
        case WeavePattern::Plain:
            return {{0, 1}, {1, 0}};
        case WeavePattern::Twill2x2:
            return {{1, 1, 0, 0}, {0, 1, 1, 0}, {0, 0, 1, 1}, {1, 0, 0, 1}};
        case WeavePattern::DoubleWarp:
            return {{1}};
        case WeavePattern::DoubleWeft:
            return {{0}};
        case WeavePattern::Satin5:
            return {{1, 0, 0, 0, 0},
                    {0, 0, 1, 0, 0},
                    {0, 0, 0, 0, 1},
                    {0, 1, 0, 0, 0},
                    {0, 0, 0, 1, 0}};
        case WeavePattern::Basket2x2:
            return {{1, 1, 0, 0}, {1, 1, 0, 0}, {0, 0, 1, 1}, {0, 0, 1, 1}};
        case WeavePattern::Matrix:
            break;
    }
    return params.matrix;
}

int pattern_period(const WeaveParams& params) {
    return static_cast<int>(pattern_matrix(params).front().size());
}

}  // namespace leafcutter::fab
