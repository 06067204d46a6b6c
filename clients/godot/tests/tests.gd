extends Node3D
## What `orogeny_live.gd` does against a running service: OROGENY_SERVICE_URL says where, OROGENY_SERVICE_TOKEN is what
## it asks for. Its terrain `t` has 420 × 300 samples, one every 2 m, and is painted on.
##
## The service has to stop and to start again where a line of the output asks for it.

const WAIT_S := 60.0
const SIZE := Vector2i(420, 300)

var _url := OS.get_environment("OROGENY_SERVICE_URL")
var _token := OS.get_environment("OROGENY_SERVICE_TOKEN")
var _events: Array[Dictionary] = []
var _lost: Array[String] = []
var _changes: Array[Rect2i] = []
var _num_held := 0
var _num_problems := 0

@onready var _live: OrogenyLive = $Live


func _ready() -> void:
	_live.event_received.connect(_events.append)
	_live.connection_lost.connect(_lost.append)
	_live.heights_changed.connect(_take_change)
	_live.url = _url
	await _says_why_it_is_refused()
	await _follows_all_of_a_terrain()
	await _paints_and_takes_back()
	await _makes_a_mesh_and_a_collision_that_follow()
	await _follows_a_region_of_a_coarser_level()
	await _gives_up_where_there_is_nothing_to_follow()
	await _leaves_the_tree_and_comes_back()
	await _comes_back_with_the_service()
	print("%d held, %d problems" % [_num_held, _num_problems])
	get_tree().quit(0 if _num_problems == 0 else 1)


func _says_why_it_is_refused() -> void:
	_live.enabled = true
	await _until("a refusal without a token", func() -> bool: return not _lost.is_empty())
	_check("a token is missing: %s" % str(_lost), _lost[-1].contains("token"))
	_check("nothing can be sent: 0", _live.undo() == 0)
	_live.token = "not-this-one-at-all"
	_reopen()
	await _until("a refusal of a token", func() -> bool: return not _lost.is_empty())
	_check("a token is wrong: %s" % str(_lost), _lost[-1].contains("token"))
	_live.token = _token
	_live.terrain = "no such one"
	_reopen()
	await _until("a refusal of a terrain", func() -> bool: return not _lost.is_empty())
	_check("there is no such terrain: %s" % str(_lost), _lost[-1].contains("no such one"))
	_live.terrain = "t"
	_live.url = "http://127.0.0.1:1"
	_reopen()
	await _until("a refusal of a port", func() -> bool: return not _lost.is_empty())
	_check("nobody is there: %s" % str(_lost), _lost[-1].contains("http://127.0.0.1:1"))
	_live.url = _url


func _follows_all_of_a_terrain() -> void:
	_reopen()
	await _until("all heights", func() -> bool: return _covered() == Rect2i(Vector2i.ZERO, SIZE))
	_check("the size", _live.size == SIZE and is_equal_approx(_live.spacing, 2.0))
	await _paint([{"op": "stroke", "brush": {"type": "raise", "radius": 300, "strength": 90}, "points": [[700, 400]]}])
	await _until("someone else's hill", func() -> bool: return _live.height_at(Vector3(700, 0, 400)) > 50.0)
	await _check_heights("as the service has them, after someone else's stroke")


func _paints_and_takes_back() -> void:
	var before := _live.heights.duplicate()
	_changes.clear()
	var id := _live.stroke({"type": "lower", "radius": 30, "strength": 12}, PackedVector2Array([Vector2(520, 300), Vector2(560, 310)]))
	var done := await _answer(id)
	_check("a stroke is done: %s" % str(done), done["event"] == "done" and not (done["entries"] as Array).is_empty())
	await _until("what it changed", func() -> bool: return _live.height_at(Vector3(540, 0, 305)) < before[152 * SIZE.x + 270] - 1.0)
	await _check_heights("after a stroke")
	var rect: Array = done["rect"]
	var told := Rect2(rect[0], rect[1], rect[2], rect[3])
	var changed := _covered()
	var changed_m := Rect2(Vector2(changed.position) * 2.0, Vector2(changed.size) * 2.0)
	_check("changed %s lies within %s" % [changed_m, told], told.grow(2.0).encloses(changed_m))
	_check("changed %s reaches the stroke's ends" % changed_m, changed_m.encloses(Rect2(495, 275, 90, 60)))
	var exact := Rect2i()
	for i in before.size():
		if before[i] != _live.heights[i]:
			@warning_ignore("integer_division")
			var place := Rect2i(i % SIZE.x, i / SIZE.x, 1, 1)
			exact = exact.merge(place) if exact.has_area() else place
	_check("%s are the samples that changed, %s" % [changed, exact], changed == exact)
	var after := _live.heights.duplicate()
	done = await _answer(_live.undo())
	_check("an undo is done: %s" % str(done), done["event"] == "done")
	await _until("the ground of before", func() -> bool: return _live.heights.to_byte_array() == before.to_byte_array())
	done = await _answer(_live.redo())
	_check("a redo is done: %s" % str(done), done["event"] == "done")
	await _until("the ground of after", func() -> bool: return _live.heights.to_byte_array() == after.to_byte_array())
	var wrong := await _answer(_live.stroke({"type": "no such brush"}, PackedVector2Array([Vector2.ZERO])))
	_check("a brush that is none: %s" % str(wrong), wrong["event"] == "error")
	# More than what a WebSocketPeer sends at once unless it is told to.
	var many := PackedVector2Array()
	for i in 4000:
		many.append(Vector2(100.125 + i * 0.18, 500.0 + sin(i * 0.01) * 4.0))
	done = await _answer(_live.stroke({"type": "raise", "radius": 10, "strength": 2}, many))
	_check("a long stroke is done", done["event"] == "done")
	await _until("the long stroke", func() -> bool: return _live.height_at(Vector3(750, 0, 500)) > 0.5)
	await _check_heights("after a long stroke")


func _makes_a_mesh_and_a_collision_that_follow() -> void:
	_live.make_collision = true
	var paint := StandardMaterial3D.new()
	_live.position = Vector3(5, -3, 11)
	_reopen()
	await _until("all heights again", func() -> bool: return _covered() == Rect2i(Vector2i.ZERO, SIZE))
	_live.material = paint
	await _check_shown("of all")
	var pieces := _pieces()
	_check("4 × 3 pieces with the material", pieces.size() == 12 and pieces.all(func(piece: MeshInstance3D) -> bool: return piece.material_override == paint))
	var meshes := pieces.map(func(piece: MeshInstance3D) -> Mesh: return piece.mesh)
	await _answer(_live.stroke({"type": "raise", "radius": 20, "strength": 30}, PackedVector2Array([Vector2(600, 450)])))
	await _until("a hill", func() -> bool: return _live.height_at(Vector3(600, 0, 450)) > 20.0)
	await _check_shown("after a stroke")
	var num_new := 0
	for i in meshes.size():
		num_new += 1 if _pieces()[i].mesh != meshes[i] else 0
	_check("%d of %d pieces are made anew" % [num_new, meshes.size()], num_new >= 1 and num_new <= 4)


func _follows_a_region_of_a_coarser_level() -> void:
	for level: int in [0, 1]:
		_live.level = level
		_live.region_begin = Vector2(411, 299)
		_live.region_size = Vector2(402.5, 301)
		_reopen()
		await _until("the region", func() -> bool: return _live.size != Vector2i.ZERO and _covered() == Rect2i(Vector2i.ZERO, _live.size))
		await _check_heights("of a region of level %d" % level)
		await _check_shown("of a region of level %d" % level)
		await _paint([{"op": "stroke", "brush": {"type": "raise", "radius": 40, "strength": 20}, "points": [[800, 590]]}])
		await _until("a change at its edge", func() -> bool: return _changes.size() > 1)
		await _settle()
		await _check_heights("of a region of level %d that changed" % level)
		await _check_shown("of a region of level %d that changed" % level)
	_live.level = 0


func _gives_up_where_there_is_nothing_to_follow() -> void:
	_live.region_begin = Vector2(5000, 5000)
	_reopen()
	await _until("a complaint", func() -> bool: return not _lost.is_empty())
	_check("the region lies outside: %s" % str(_lost), _lost[-1].contains("region"))
	_live.region_begin = Vector2.ZERO
	_live.region_size = Vector2.ZERO
	_live.level = 5
	_reopen()
	await _until("another complaint", func() -> bool: return not _lost.is_empty())
	_check("there is no such level: %s" % str(_lost), _lost[-1].contains("level"))
	_lost.clear()
	await get_tree().create_timer(3.0).timeout
	_check("nothing is tried again", _lost.is_empty() and _live.heights.is_empty() and _pieces().is_empty())
	_live.level = 0


func _leaves_the_tree_and_comes_back() -> void:
	_reopen()
	await _until("all heights", func() -> bool: return _covered() == Rect2i(Vector2i.ZERO, SIZE))
	remove_child(_live)
	_events.clear()
	add_child(_live)
	await _until("a hello in the tree again", func() -> bool: return _events.any(func(event: Dictionary) -> bool: return event["event"] == "hello"))


func _comes_back_with_the_service() -> void:
	await _until("the mesh", func() -> bool: return _pieces().size() == 12)
	await _settle()
	var before := _live.heights.duplicate()
	_lost.clear()
	_events.clear()
	print("stop the service")
	await _until("the end", func() -> bool: return not _lost.is_empty())
	_check("it stopped: %s" % str(_lost), _lost[0].contains("1001"))
	await _until("a vain try", func() -> bool: return _lost.size() > 1)
	_check("nobody is there: %s" % str(_lost), _lost[-1].contains(_url))
	_check("the ground stays meanwhile", _live.heights == before and _pieces().size() == 12)
	print("start the service")
	_events.clear()
	await _until("the service again", func() -> bool: return _events.any(func(event: Dictionary) -> bool: return event["event"] == "hello"))
	_check("the ground stays when it is there again", _live.heights == before and _pieces().size() == 12)
	await _paint([{"op": "stroke", "brush": {"type": "raise", "radius": 30, "strength": 25}, "points": [[200, 200]]}])
	await _until("a change", func() -> bool: return _live.height_at(Vector3(200, 0, 200)) > 15.0)
	await _check_heights("after the service came back")
	await _check_shown("after the service came back")


## The meshes and the collision are where the heights are, and face upwards.
func _check_shown(what: String) -> void:
	var faces := 0
	var wrong := 0
	for piece in _pieces():
		var arrays := piece.mesh.surface_get_arrays(0)
		var vertices: PackedVector3Array = arrays[Mesh.ARRAY_VERTEX]
		var normals: PackedVector3Array = arrays[Mesh.ARRAY_NORMAL]
		var indices: PackedInt32Array = arrays[Mesh.ARRAY_INDEX]
		for i in vertices.size():
			wrong += 1 if not is_equal_approx(vertices[i].y, _live.height_at(vertices[i])) else 0
		for i in range(0, indices.size(), 3):
			var corners := [vertices[indices[i]], vertices[indices[i + 1]], vertices[indices[i + 2]]]
			# Godot's faces are clockwise.
			var face: Vector3 = (corners[2] - corners[0]).cross(corners[1] - corners[0]).normalized()
			wrong += 1 if face.y <= 0.0 or face.dot(normals[indices[i]]) < 0.6 else 0
			faces += 1
	var quads := (_live.size.x - 1) * (_live.size.y - 1)
	_check("a mesh %s: %d triangles, %d wrong" % [what, faces, wrong], faces == quads * 2 and wrong == 0)
	await get_tree().physics_frame
	await get_tree().physics_frame
	var worst := 0.0
	var num_hit := 0
	var begin := Vector2(_live.first) * _live.spacing
	for z in 12:
		for x in 12:
			var part := Vector2(x + 0.45, z + 0.55) / 12.0
			var place := begin + part * Vector2(_live.size - Vector2i.ONE) * _live.spacing
			var from := _live.to_global(Vector3(place.x, 500, place.y))
			var ray := PhysicsRayQueryParameters3D.create(from, from + Vector3.DOWN * 1000.0)
			var hit := get_world_3d().direct_space_state.intersect_ray(ray)
			if hit.has("position"):
				num_hit += 1
				var here := _live.to_local(hit["position"])
				worst = maxf(worst, absf(here.y - _live.height_at(here)))
	# A quad's two triangles lie off the bilinear surface by what it is bent.
	_check("a collision %s: %d rays, %f m off at most" % [what, num_hit, worst], num_hit == 144 and worst < 0.5)


func _check_heights(what: String) -> void:
	var query := "?format=r32&level=%d" % _live.level
	if _live.region_size.x > 0.0:
		query += "&x=%f&z=%f&width=%f&depth=%f" % [_live.region_begin.x, _live.region_begin.y, _live.region_size.x, _live.region_size.y]
	var answer := await _call(HTTPClient.METHOD_GET, "/v1/terrains/t/heights" + query)
	var headers := {}
	for line: String in answer[2]:
		headers[line.get_slice(":", 0).to_lower()] = line.get_slice(":", 1).strip_edges()
	var size := Vector2i(int(str(headers["orogeny-width"])), int(str(headers["orogeny-depth"])))
	var first := Vector2(float(str(headers["orogeny-x"])), float(str(headers["orogeny-z"])))
	_check("the place %s of %s samples %s" % [first, size, what], size == _live.size and first == Vector2(_live.first) * _live.spacing)
	_check("heights, bit for bit, %s" % what, answer[3] == _live.heights.to_byte_array())


func _paint(operations: Array) -> void:
	var answer := await _call(HTTPClient.METHOD_POST, "/v1/terrains/t/operations", JSON.stringify({"operations": operations}))
	_check("someone else paints", answer[1] == 200)


func _call(method: HTTPClient.Method, path: String, body := "") -> Array:
	var request := HTTPRequest.new()
	add_child(request)
	var headers := PackedStringArray(["Authorization: Bearer " + _token, "Content-Type: application/json"])
	request.request(_url + path, headers, method, body)
	var answer: Array = await request.request_completed
	request.queue_free()
	return answer


func _answer(id: int) -> Dictionary:
	_check("it was sent", id > 0)
	var is_it := func(event: Dictionary) -> bool: return event["event"] in ["done", "error"] and event.get("id") == id
	await _until("an answer", func() -> bool: return _events.any(is_it))
	return _events.filter(is_it)[0]


## Until no more changes come for a while.
func _settle() -> void:
	var count := -1
	while count != _changes.size():
		count = _changes.size()
		await get_tree().create_timer(1.0).timeout


func _until(what: String, is_so: Callable) -> void:
	var end := Time.get_ticks_msec() + WAIT_S * 1000.0
	while not is_so.call():
		if Time.get_ticks_msec() > end:
			print("PROBLEM: never came: %s. Lost: %s. Events: %s" % [what, _lost, _events])
			get_tree().quit(1)
			# Nobody goes on from here.
			await get_tree().create_timer(WAIT_S).timeout
		await get_tree().process_frame


func _check(what: String, is_so: bool) -> void:
	print("%s: %s" % ["ok" if is_so else "PROBLEM", what])
	if is_so:
		_num_held += 1
	else:
		_num_problems += 1


func _reopen() -> void:
	_live.enabled = false
	_events.clear()
	_lost.clear()
	_changes.clear()
	_live.enabled = true


func _pieces() -> Array[MeshInstance3D]:
	var pieces: Array[MeshInstance3D] = []
	for child in _live.get_children(true):
		if child is MeshInstance3D and not child.is_queued_for_deletion():
			pieces.append(child)
	return pieces


## What all the changes cover together.
func _covered() -> Rect2i:
	var all := Rect2i()
	for changed in _changes:
		all = all.merge(changed) if all.has_area() else changed
	return all


func _take_change(_heights: PackedFloat32Array, _size: Vector2i, changed: Rect2i) -> void:
	_changes.append(changed)
