// A scene of three.js whose every frame is stylized, with its normals and depths.

import * as THREE from "three/webgpu";
import { pass } from "three/tsl";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Isophote, looks } from "isophote";
import { stylize } from "isophote/three";

async function main() {
  const renderer = new THREE.WebGPURenderer({ antialias: true });
  renderer.toneMapping = THREE.AgXToneMapping;
  await renderer.init();
  if (!renderer.backend.isWebGPUBackend) {
    throw new Error("this browser has no WebGPU, which Isophote computes with");
  }
  document.body.append(renderer.domElement);

  const { scene, camera, knot } = world();
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.enableDamping = true;

  const isophote = await Isophote.create({ device: renderer.backend.device });
  const scenePass = pass(scene, camera);
  const stylized = stylize(isophote, looks.saturday_comic, scenePass);
  const pipeline = new THREE.RenderPipeline(renderer);
  pipeline.outputNode = stylized;
  pipeline.outputColorTransform = false;

  const select = document.querySelector("#look");
  for (const [id, look] of Object.entries(looks)) {
    select.add(new Option(look.name, id, id === "saturday_comic", id === "saturday_comic"));
  }
  tell("The look compiles…");
  stylized.ready.then(() => tell(""), tell);
  select.addEventListener("change", () => stylized.setLook(looks[select.value]).catch(tell));

  const resize = () => {
    renderer.setPixelRatio(window.devicePixelRatio);
    renderer.setSize(window.innerWidth, window.innerHeight);
    camera.aspect = window.innerWidth / window.innerHeight;
    camera.updateProjectionMatrix();
  };
  window.addEventListener("resize", resize);
  resize();

  renderer.setAnimationLoop((time) => {
    knot.rotation.y = time / 4000;
    controls.update();
    pipeline.render();
  });
}

/** Things on a table, under a sky. */
function world() {
  const scene = new THREE.Scene();
  scene.background = new THREE.Color("#8fb7d6");
  scene.add(new THREE.HemisphereLight("#cfe4ff", "#6b5a48", 1.6));
  const sun = new THREE.DirectionalLight("#fff2dc", 3.2);
  sun.position.set(4, 7, 3);
  scene.add(sun);

  const add = (geometry, color, [x, y, z]) => {
    const material = new THREE.MeshStandardMaterial({ color, roughness: 0.55 });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.position.set(x, y, z);
    scene.add(mesh);
    return mesh;
  };
  add(new THREE.CylinderGeometry(4, 4, 0.3, 96), "#b58a5c", [0, -0.15, 0]);
  add(new THREE.SphereGeometry(0.9, 64, 32), "#d2493a", [-1.9, 0.9, 0.6]);
  add(new THREE.BoxGeometry(1.4, 1.4, 1.4), "#3f7f5f", [1.9, 0.7, 0.9]);
  add(new THREE.ConeGeometry(0.8, 1.9, 48), "#e0b040", [0.4, 0.95, -1.9]);
  const knot = add(new THREE.TorusKnotGeometry(0.75, 0.26, 192, 32), "#4a6fb5", [0, 1.35, 0.4]);

  const camera = new THREE.PerspectiveCamera(40, 1, 0.1, 100);
  camera.position.set(0, 4, 8);
  camera.lookAt(0, 0.6, 0);
  return { scene, camera, knot };
}

/** Shows a message, or what went wrong. */
function tell(message) {
  document.querySelector("#message").textContent = message.message ?? message;
}

main().catch(tell);
