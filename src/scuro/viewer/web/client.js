// Shows the pictures that the server sends and sends it what hands do (rendercanvas' renderview).
'use strict'

const status = document.getElementById('status')
const scheme = window.location.protocol === 'https:' ? 'wss://' : 'ws://'
const socket = new WebSocket(scheme + window.location.host + '/view')
socket.binaryType = 'arraybuffer'

class View extends window.BaseRenderView {
  constructor (wrapper) {
    const image = document.createElement('img')
    image.alt = 'scuro'
    image.decoding = 'sync'
    image.style.touchAction = 'none'
    // set here, or renderview chooses a size of its own
    image.style.width = image.style.height = '100%'
    image.ondragstart = () => false
    // in the page before its size is asked for
    wrapper.appendChild(image)
    super(image, null)
    this.setThrottle(20)
  }

  onEvent (event) {
    if (event.type === 'resize') {
      // some browsers that emulate another screen count physical pixels as if they were logical
      const { width, height } = this.viewElement.getBoundingClientRect()
      if (Math.abs(width - event.width) > 1 || Math.abs(height - event.height) > 1) {
        Object.assign(event, { width, height, pwidth: width * event.ratio, pheight: height * event.ratio })
      }
    }
    if (socket.readyState === WebSocket.OPEN) { socket.send(JSON.stringify(event)) }
  }
}

let view = null
let header = null
let shown = null

function show (buffer, mimetype, index) {
  const source = URL.createObjectURL(new Blob([buffer], { type: mimetype }))
  view.viewElement.onload = () => {
    if (shown !== null) { URL.revokeObjectURL(shown) }
    shown = source
    // for tools that wait for a picture: its number, and whether it is the full one
    view.viewElement.dataset.index = index
    view.viewElement.dataset.full = mimetype === 'image/png'
    view.onEvent({ type: 'shown', index })
  }
  view.viewElement.src = source
}

function save (buffer, name) {
  const link = document.createElement('a')
  link.href = URL.createObjectURL(new Blob([buffer]))
  link.download = name
  link.click()
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10000)
}

// Two fingers: their distance zooms, their middle shifts; renderview reports single pointers only.
function followFingers (element) {
  const fingers = new Map()
  let last = null
  const measure = () => {
    const [a, b] = [...fingers.values()]
    return { x: (a.x + b.x) / 2, y: (a.y + b.y) / 2, d: Math.hypot(a.x - b.x, a.y - b.y) }
  }
  const base = (type, at, button) => ({
    type, x: at.x, y: at.y, button, buttons: [], modifiers: [], timestamp: 0
  })
  element.addEventListener('pointerdown', (e) => {
    if (e.pointerType !== 'touch') { return }
    fingers.set(e.pointerId, { x: e.offsetX, y: e.offsetY })
    // not for renderview, which would begin to turn with the second finger
    if (fingers.size > 1) { e.stopImmediatePropagation() }
    if (fingers.size === 2) {
      last = measure()
      view.onEvent(base('pointer_up', last, 1))
      view.onEvent(base('pointer_down', last, 2))
    }
  }, true)
  element.addEventListener('pointermove', (e) => {
    if (!fingers.has(e.pointerId)) { return }
    fingers.set(e.pointerId, { x: e.offsetX, y: e.offsetY })
    if (fingers.size !== 2) { return }
    e.stopImmediatePropagation()
    const now = measure()
    view.onEvent(base('pointer_move', now, 0))
    // ten percent of distance is one notch of a wheel
    const notches = Math.log(now.d / last.d) / Math.log(1.1)
    view.onEvent({ ...base('wheel', now, 0), dx: 0, dy: -100 * notches })
    last = now
  }, true)
  const lift = (e) => {
    if (fingers.size === 2 && fingers.has(e.pointerId)) {
      view.onEvent(base('pointer_up', last, 2))
    }
    fingers.delete(e.pointerId)
  }
  element.addEventListener('pointerup', lift, true)
  element.addEventListener('pointercancel', lift, true)
}

// A gamepad's sticks and triggers, while they are off their rest; once more when they return.
function followGamepad () {
  let moving = false
  const dead = (v) => (Math.abs(v) < 0.15 ? 0 : Math.round(v * 100) / 100)
  const look = () => {
    const pad = [...navigator.getGamepads()].find((p) => p && p.mapping === 'standard')
    if (!pad) { return }
    const [x, y, u, v] = pad.axes.map(dead)
    const z = dead(pad.buttons[7].value - pad.buttons[6].value)
    const now = [x, y, u, v, z].some((value) => value !== 0)
    if (now || moving) {
      view.onEvent({ type: 'gamepad', x, y: -y, z: -z, turn_x: u, turn_y: v })
    }
    moving = now
  }
  let timer = null
  window.addEventListener('gamepadconnected', () => { timer = timer || setInterval(look, 33) })
  window.addEventListener('gamepaddisconnected', () => {
    if ([...navigator.getGamepads()].every((p) => !p)) { clearInterval(timer); timer = null }
  })
}

socket.onopen = () => {
  status.textContent = ''
  view = new View(document.getElementById('canvas'))
  followFingers(view.viewElement)
  followGamepad()
  // keys work without a click first
  document.querySelector('#rendercanvas-focus-element-container input')?.focus({ preventScroll: true })
}
socket.onmessage = (message) => {
  if (typeof message.data === 'string') {
    header = JSON.parse(message.data)
  } else if (header.type === 'picture') {
    show(message.data, header.mimetype, header.index)
  } else if (header.type === 'file') {
    save(message.data, header.name)
  }
}
socket.onclose = (event) => {
  status.textContent = (event.reason || 'disconnected') + ': reload the page to connect again'
}
