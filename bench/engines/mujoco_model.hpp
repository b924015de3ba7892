// MuJoCo's model of a description in its XML.
#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

namespace tumble::bench {

struct MujocoDeleter {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoModel = std::unique_ptr<mjModel, MujocoDeleter>;
using MujocoData = std::unique_ptr<mjData, MujocoDeleter>;

// Throws std::runtime_error with MuJoCo's own message.
[[nodiscard]] inline MujocoModel mujoco_model(const std::string& xml) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "scene.xml", static_cast<int>(xml.size()) + 1);
    const int file = mj_findFileVFS(files.get(), "scene.xml");
    if (file < 0) throw std::runtime_error{"MuJoCo takes no file"};
    std::memcpy(files->filedata[file], xml.c_str(), xml.size() + 1);
    char message[1000] = "";
    MujocoModel model{mj_loadXML("scene.xml", files.get(), message, sizeof message)};
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error{message};
    return model;
}

}  // namespace tumble::bench
