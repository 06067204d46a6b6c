@tool
class_name OrogenyLive
extends Node3D
## Follows a region of a terrain on the live channel of an Orogeny service.
##
## Pages are put together into one field of heights, which [signal heights_changed] hands out whenever it changed.
## With [member show_mesh] a child MeshInstance3D shows it, with [member make_collision] a child StaticBody3D collides.
## Metres are Godot's units: x goes to the east, y up, z to the south, and the node lies at the terrain's north-west
## corner.

## Some of the heights changed, or all of them came. [param heights] are metres, row by row from the north-west,
## [param size] samples along x and z, [param changed] the samples that changed.
signal heights_changed(heights: PackedFloat32Array, size: Vector2i, changed: Rect2i)
## An event of the service, as it came: `hello`, `operation`, `clients`, `done`, `error` and others.
signal event_received(event: Dictionary)
## The connection was lost, or refused. With [member reconnect] another one is tried.
signal connection_lost(why: String)

const PAGE_SIZE := 256
const HEADER_BYTES := 40
## Pages along one side of a terrain, at most.
const MAX_PAGES := 1 << 22
const MAX_MESSAGE_BYTES := 8 * 1024 * 1024
## Samples of a region, at most: more need a coarser level.
const MAX_SAMPLES := 4096 * 4096
## Samples along one side of a piece of the mesh.
const PIECE := 128
const RECONNECT_AFTER_S := 2.0
const WINDOW := 16

@export var url := "http://127.0.0.1:4750"
## Which terrain: the file's name without its ending.
@export var terrain := ""
## What the history names whoever paints from here.
@export var author := "Godot"
## What the service asks for, where it does. It is kept in the scene: better set it by a script, or leave it empty and
## set the environment variable OROGENY_TOKEN.
@export var token := ""
## Where the region begins, metres from the terrain's north-west corner: x to the east, y to the south.
@export var region_begin := Vector2.ZERO
## How wide and deep it is, metres. 0: all of the terrain.
@export var region_size := Vector2.ZERO
## 0 is full resolution; each next level has one sample for two each way.
@export_range(0, 31) var level := 0
@export var show_mesh := true
@export var make_collision := false
@export var material: Material
@export var reconnect := true
## Whether it is connected, in the editor too.
@export var enabled := true:
	set(value):
		enabled = value
		if is_inside_tree():
			_close()
			if value:
				open()

## The heights, metres, row by row from the north-west; 0 where no page has come yet.
var heights := PackedFloat32Array()
## Samples along x and z.
var size := Vector2i.ZERO
## Metres between samples.
var spacing := 1.0
## Samples of the level west and north of the region.
var first := Vector2i.ZERO
## The latest revision that a page came with.
var revision := 0

var _socket: WebSocketPeer
var _wait_s := 0.0
var _taken := 0
var _last_id := 0
var _level_size := Vector2i.ZERO
var _changed := Rect2i()
var _pieces: Dictionary = {}
var _shape: CollisionShape3D


func _ready() -> void:
	if enabled:
		open()


func _exit_tree() -> void:
	_close()


func _process(delta: float) -> void:
	if _socket == null:
		if enabled and reconnect and _wait_s > 0.0:
			_wait_s -= delta
			if _wait_s <= 0.0:
				open()
		return
	_socket.poll()
	var state := _socket.get_ready_state()
	if state == WebSocketPeer.STATE_OPEN:
		_receive()
		_tell_changes()
	elif state == WebSocketPeer.STATE_CLOSED:
		_lose("closed by the service (%d) %s" % [_socket.get_close_code(), _socket.get_close_reason()])


## Connects, and follows the region as it is set now.
func open() -> void:
	_close()
	if terrain.is_empty():
		return
	var parts := url.trim_suffix("/").split("://")
	if parts.size() != 2 or parts[0] not in ["http", "https"]:
		_lose("the service's address is such as http://127.0.0.1:4750")
		return
	_socket = WebSocketPeer.new()
	_socket.inbound_buffer_size = MAX_MESSAGE_BYTES
	_socket.max_queued_packets = 4096
	var secret := token if not token.is_empty() else OS.get_environment("OROGENY_TOKEN")
	if not secret.is_empty():
		if OS.has_feature("web"):
			_socket.supported_protocols = PackedStringArray(["orogeny.v1", "bearer." + secret])
		else:
			_socket.handshake_headers = PackedStringArray(["Authorization: Bearer " + secret])
	var scheme := "wss" if parts[0] == "https" else "ws"
	var path := "/v1/terrains/%s/live?author=%s" % [terrain.uri_encode(), author.uri_encode()]
	var error := _socket.connect_to_url("%s://%s%s" % [scheme, parts[1], path])
	if error != OK:
		_lose(error_string(error))


## Draws a stroke. [param points] are places on the terrain, metres: x to the east, y to the south. Returns the number
## by which `done` or `error` will answer in [signal event_received].
func stroke(brush: Dictionary, points: PackedVector2Array, layer := "") -> int:
	var operation := {"op": "stroke", "brush": brush}
	if not layer.is_empty():
		operation["layer"] = layer
	var places := []
	for point in points:
		places.append([point.x, point.y])
	operation["points"] = places
	return _ask({"type": "apply", "operations": [operation]})


## Takes back what this author did last.
func undo() -> int:
	return _ask({"type": "undo"})


## Does again what this author took back last.
func redo() -> int:
	return _ask({"type": "redo"})


## The height at a place of this node's own space, metres, bilinear between samples.
func height_at(place: Vector3) -> float:
	if heights.is_empty():
		return 0.0
	var at := Vector2(place.x, place.z) / spacing - Vector2(first)
	at = at.clamp(Vector2.ZERO, Vector2(size - Vector2i.ONE))
	var low := Vector2i(at).min(size - Vector2i(2, 2)).max(Vector2i.ZERO)
	var high := (low + Vector2i.ONE).min(size - Vector2i.ONE)
	var along := at - Vector2(low)
	var north := lerpf(heights[low.y * size.x + low.x], heights[low.y * size.x + high.x], along.x)
	var south := lerpf(heights[high.y * size.x + low.x], heights[high.y * size.x + high.x], along.x)
	return lerpf(north, south, along.y)


func _ask(message: Dictionary) -> int:
	_last_id += 1
	message["id"] = _last_id
	_send(message)
	return _last_id


func _send(message: Dictionary) -> void:
	if _socket != null and _socket.get_ready_state() == WebSocketPeer.STATE_OPEN:
		_socket.send_text(JSON.stringify(message))


func _close() -> void:
	if _socket != null:
		_socket.close()
		_socket = null
	_wait_s = 0.0
	_taken = 0


func _lose(why: String) -> void:
	_close()
	_wait_s = RECONNECT_AFTER_S
	connection_lost.emit(why)


func _receive() -> void:
	var frames := 0
	while _socket != null and _socket.get_available_packet_count() > 0:
		var packet := _socket.get_packet()
		if _socket.was_string_packet():
			_take_event(packet.get_string_from_utf8())
		elif _take_frame(packet):
			frames += 1
		else:
			_lose("a page frame that cannot be read")
			return
	if frames > 0:
		# The service holds pages back until it hears this, and then sends the latest state of each.
		_taken += frames
		_send({"type": "ack", "frames": _taken})


func _take_event(text: String) -> void:
	var event: Variant = JSON.parse_string(text)
	if not event is Dictionary or not event.has("event"):
		_lose("a message that is no event")
		return
	if event["event"] == "hello":
		_begin(event)
	event_received.emit(event)


func _begin(hello: Dictionary) -> void:
	if int(hello["page_size"]) != PAGE_SIZE:
		_lose("pages have %d samples a side, this script knows %d" % [hello["page_size"], PAGE_SIZE])
		return
	spacing = float(hello["spacing"]) * pow(2.0, level)
	_level_size = Vector2i((int(hello["width"]) - 1 >> level) + 1, (int(hello["depth"]) - 1 >> level) + 1)
	var end := _level_size
	var region: Variant = null
	first = Vector2i.ZERO
	if region_size.x > 0.0 and region_size.y > 0.0:
		region = [region_begin.x, region_begin.y, region_size.x, region_size.y]
		first = _sample_at(region_begin).clamp(Vector2i.ZERO, _level_size)
		end = _sample_at(region_begin + region_size).clamp(Vector2i.ZERO, _level_size)
	size = end - first
	if size.x < 2 or size.y < 2 or size.x * size.y > MAX_SAMPLES:
		size = Vector2i.ZERO
		enabled = false
		connection_lost.emit("the region lies outside, is too small, or needs a coarser level")
		return
	heights.resize(size.x * size.y)
	heights.fill(0.0)
	revision = 0
	_clear_children()
	var message := {"type": "subscribe", "level": level, "format": "r32", "window": WINDOW}
	if region != null:
		message["region"] = region
	_send(message)


func _sample_at(place: Vector2) -> Vector2i:
	return Vector2i(_sample_along(place.x), _sample_along(place.y))


func _sample_along(place_m: float) -> int:
	# A place may miss a sample of full resolution by a millionth of a spacing and still be on it.
	var full := spacing / pow(2.0, level)
	var at_full := ceili(clampf(place_m / full, -1e9, 1e9) - 1e-6)
	return ceili(at_full / pow(2.0, level))


## Reads a page frame into the heights; whether it is one.
func _take_frame(frame: PackedByteArray) -> bool:
	if frame.size() < HEADER_BYTES or frame.slice(0, 4).get_string_from_ascii() != "OROG":
		return false
	if frame.decode_u16(4) != 1 or frame.decode_u16(6) != 0 or frame.decode_u8(9) != 0:
		return false
	var page_size := Vector2i(frame.decode_u16(10), frame.decode_u16(12))
	var place := Vector2i(frame.decode_u32(16), frame.decode_u32(20))
	var is_page := mini(page_size.x, page_size.y) >= 1 and maxi(page_size.x, page_size.y) <= PAGE_SIZE
	is_page = is_page and maxi(place.x, place.y) < MAX_PAGES and mini(place.x, place.y) >= 0
	var bytes := page_size.x * page_size.y * 4
	if not is_page or frame.decode_u32(32) != bytes or frame.size() != HEADER_BYTES + bytes:
		return false
	if frame.decode_u8(8) != level:
		# Of what was followed before.
		return true
	var page := Rect2i(place * PAGE_SIZE, page_size)
	var part := page.intersection(Rect2i(first, size))
	if not part.has_area():
		return true
	revision = maxi(revision, frame.decode_u64(24))
	var samples := frame.slice(HEADER_BYTES).to_float32_array()
	for z in range(part.position.y, part.end.y):
		var from := (z - page.position.y) * page_size.x + part.position.x - page.position.x
		var to := (z - first.y) * size.x + part.position.x - first.x
		for i in part.size.x:
			heights[to + i] = samples[from + i]
	var here := Rect2i(part.position - first, part.size)
	_changed = here if not _changed.has_area() else _changed.merge(here)
	return true


func _tell_changes() -> void:
	if not _changed.has_area():
		return
	var changed := _changed
	_changed = Rect2i()
	if show_mesh:
		_update_mesh(changed)
	if make_collision:
		_update_collision()
	heights_changed.emit(heights, size, changed)


func _clear_children() -> void:
	for piece: MeshInstance3D in _pieces.values():
		piece.queue_free()
	_pieces.clear()
	if _shape != null:
		_shape.get_parent().queue_free()
		_shape = null


## Makes those pieces of the mesh anew that hold a change. A sample more all around, for normals reach to the next one.
func _update_mesh(changed: Rect2i) -> void:
	var wide := changed.grow(1).intersection(Rect2i(Vector2i.ZERO, size))
	# A sample between two pieces belongs to both.
	var from := (wide.position - Vector2i.ONE).max(Vector2i.ZERO) / PIECE
	var to := (wide.end - Vector2i.ONE).min(size - Vector2i(2, 2)) / PIECE
	for row in range(from.y, to.y + 1):
		for column in range(from.x, to.x + 1):
			_update_piece(Vector2i(column, row))


func _update_piece(piece: Vector2i) -> void:
	var begin := piece * PIECE
	var side := (size - begin).min(Vector2i(PIECE + 1, PIECE + 1))
	var vertices := PackedVector3Array()
	var normals := PackedVector3Array()
	vertices.resize(side.x * side.y)
	normals.resize(side.x * side.y)
	for z in side.y:
		var row := begin.y + z
		var north := maxi(row - 1, 0) * size.x
		var south := mini(row + 1, size.y - 1) * size.x
		for x in side.x:
			var column := begin.x + x
			var west := maxi(column - 1, 0)
			var east := mini(column + 1, size.x - 1)
			var i := z * side.x + x
			var middle := row * size.x
			vertices[i] = Vector3((first.x + column) * spacing, heights[middle + column], (first.y + row) * spacing)
			var slope_x := (heights[middle + east] - heights[middle + west]) / (spacing * (east - west))
			var slope_z := (heights[south + column] - heights[north + column]) / (spacing * (south - north) / size.x)
			normals[i] = Vector3(-slope_x, 1.0, -slope_z).normalized()
	var arrays := []
	arrays.resize(Mesh.ARRAY_MAX)
	arrays[Mesh.ARRAY_VERTEX] = vertices
	arrays[Mesh.ARRAY_NORMAL] = normals
	arrays[Mesh.ARRAY_INDEX] = _triangles(side)
	var mesh := ArrayMesh.new()
	mesh.add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)
	if not _pieces.has(piece):
		var instance := MeshInstance3D.new()
		instance.material_override = material
		add_child(instance, false, Node.INTERNAL_MODE_BACK)
		_pieces[piece] = instance
	(_pieces[piece] as MeshInstance3D).mesh = mesh


## Two triangles a quad, clockwise from above, which is what Godot takes for the front.
func _triangles(side: Vector2i) -> PackedInt32Array:
	var indices := PackedInt32Array()
	indices.resize((side.x - 1) * (side.y - 1) * 6)
	var next := 0
	for z in side.y - 1:
		for x in side.x - 1:
			var north_west := z * side.x + x
			for corner: int in [0, 1, side.x, 1, side.x + 1, side.x]:
				indices[next] = north_west + corner
				next += 1
	return indices


## A height map's samples lie one unit apart about its middle, so the shape is scaled and moved.
func _update_collision() -> void:
	if _shape == null:
		var body := StaticBody3D.new()
		add_child(body, false, Node.INTERNAL_MODE_BACK)
		_shape = CollisionShape3D.new()
		body.add_child(_shape)
		_shape.shape = HeightMapShape3D.new()
	var map := _shape.shape as HeightMapShape3D
	map.map_width = size.x
	map.map_depth = size.y
	# Godot scales shapes alike along all axes only: heights are counted in spacings, too.
	var scaled := heights.duplicate()
	for i in scaled.size():
		scaled[i] /= spacing
	map.map_data = scaled
	_shape.scale = Vector3.ONE * spacing
	var middle := (Vector2(first) + Vector2(size - Vector2i.ONE) / 2.0) * spacing
	_shape.position = Vector3(middle.x, 0.0, middle.y)
