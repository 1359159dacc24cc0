/// A peer of the fuzzy engine: libfuzzylite evaluates a rule base at given points.
///
///   fuzzylite_peer RULES POINTS OUT [RESOLUTION [EVALUATIONS]]
///
/// RULES: .fll, .fis or .fcl. POINTS, OUT: float64 as the machine has them, a row per point; the
/// columns are the inputs, the outputs. RESOLUTION: samples of the centroid; 0 (default): as the
/// file says. EVALUATIONS: only so many of the points (all): the rest of the work stays the same,
/// for those who count instructions.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fl/Headers.h>

namespace {

std::unique_ptr<fl::Importer> importer_for(const std::string &path) {
    const std::string ending = path.substr(path.find_last_of('.') + 1);
    if (ending == "fll") {
        return std::make_unique<fl::FllImporter>();
    }
    if (ending == "fis") {
        return std::make_unique<fl::FisImporter>();
    }
    if (ending == "fcl") {
        return std::make_unique<fl::FclImporter>();
    }
    throw std::runtime_error(path + ": expected .fll, .fis or .fcl");
}

std::unique_ptr<fl::Engine> read_engine(const std::string &path, int resolution) {
    std::unique_ptr<fl::Engine> engine(importer_for(path)->fromFile(path));
    std::string why;
    if (!engine->isReady(&why)) {
        throw std::runtime_error(path + ": " + why);
    }
    for (fl::OutputVariable *output : engine->outputVariables()) {
        auto *centroid = dynamic_cast<fl::IntegralDefuzzifier *>(output->getDefuzzifier());
        if (centroid != nullptr && resolution > 0) {
            centroid->setResolution(resolution);
        }
    }
    return engine;
}

std::vector<double> read_points(const std::string &path, std::size_t columns) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)),
                            std::istreambuf_iterator<char>());
    if (!file || bytes.size() % (columns * sizeof(double)) != 0) {
        throw std::runtime_error(path + ": cannot be read, or holds no whole points");
    }
    std::vector<double> points(bytes.size() / sizeof(double));
    std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char *>(points.data()));
    return points;
}

void evaluate(fl::Engine &engine, const double *inputs, double *outputs) {
    for (fl::InputVariable *input : engine.inputVariables()) {
        input->setValue(*inputs++);
    }
    engine.process();
    for (const fl::OutputVariable *output : engine.outputVariables()) {
        *outputs++ = output->getValue();
    }
}

int run(const std::vector<std::string> &words) {
    const int resolution = words.size() > 3 ? std::stoi(words[3]) : 0;
    const auto engine = read_engine(words[0], resolution);
    const std::size_t in = engine->numberOfInputVariables();
    const std::size_t out = engine->numberOfOutputVariables();
    const std::vector<double> points = read_points(words[1], in);
    const std::size_t all = points.size() / in;
    const std::size_t count =
        words.size() > 4 ? std::min<std::size_t>(all, std::stoul(words[4])) : all;
    std::vector<double> results(count * out);
    for (std::size_t i = 0; i < count; i++) {
        evaluate(*engine, &points[i * in], &results[i * out]);
    }
    std::ofstream file(words[2], std::ios::binary);
    file.write(reinterpret_cast<const char *>(results.data()),
               static_cast<std::streamsize>(results.size() * sizeof(double)));
    if (!file.flush()) {
        throw std::runtime_error(words[2] + ": cannot be written");
    }
    return EXIT_SUCCESS;
}

} // namespace

int main(int argc, char **argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() < 3 || words.size() > 5) {
        std::cerr << "usage: fuzzylite_peer RULES POINTS OUT [RESOLUTION [EVALUATIONS]]\n";
        return 2;
    }
    try {
        return run(words);
    } catch (const fl::Exception &error) {
        std::cerr << "fuzzylite_peer: " << error.getWhat() << '\n';
    } catch (const std::exception &error) {
        std::cerr << "fuzzylite_peer: " << error.what() << '\n';
    }
    return 2;
}
